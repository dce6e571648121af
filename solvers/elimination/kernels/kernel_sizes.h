// No include guard is needed but for tools: included by kernel_body.h, inside the namespace of the instruction set.
// Sizes that are compiled as constants. Adding one is one line.

// QUIVER_ROW_SIZE(N, k, e): error dimension, kept vertex, eliminated vertex.
#ifdef QUIVER_ROW_SIZE
QUIVER_ROW_SIZE(2, 9, 3)
QUIVER_ROW_SIZE(2, 7, 3)
QUIVER_ROW_SIZE(2, 8, 3)
QUIVER_ROW_SIZE(2, 6, 3)
QUIVER_ROW_SIZE(2, 4, 3)
QUIVER_ROW_SIZE(2, 3, 3)
QUIVER_ROW_SIZE(3, 6, 3)
QUIVER_ROW_SIZE(2, 6, 1)
QUIVER_ROW_SIZE(2, 3, 2)
QUIVER_ROW_SIZE(1, 3, 2)
#endif

// QUIVER_PAIR_SIZE(kRow, kColumn, e): two kept vertices of different dimensions that see the same eliminated one.
#ifdef QUIVER_PAIR_SIZE
QUIVER_PAIR_SIZE(9, 9, 3)
QUIVER_PAIR_SIZE(7, 7, 3)
QUIVER_PAIR_SIZE(6, 6, 3)
QUIVER_PAIR_SIZE(8, 8, 3)
QUIVER_PAIR_SIZE(4, 4, 3)
QUIVER_PAIR_SIZE(9, 6, 3)
QUIVER_PAIR_SIZE(6, 9, 3)
QUIVER_PAIR_SIZE(8, 6, 3)
QUIVER_PAIR_SIZE(6, 8, 3)
QUIVER_PAIR_SIZE(6, 4, 3)
QUIVER_PAIR_SIZE(4, 6, 3)
QUIVER_PAIR_SIZE(6, 3, 3)
QUIVER_PAIR_SIZE(3, 6, 3)
QUIVER_PAIR_SIZE(3, 3, 3)
QUIVER_PAIR_SIZE(6, 6, 1)
QUIVER_PAIR_SIZE(3, 3, 2)
#endif
