#pragma once

#include <cstdint>

namespace quiver::detail {

/// Predicted nanoseconds of the factorisation's parts, fitted on a 2020s x86 core. They rank alternatives (how to cut
/// the elimination tree); results never depend on how good they are, and a factor of two in any constant changes the
/// time by a few percent.

/// A front of `columns` scalar columns with `rows` scalars below them, its share of assembly included.
double frontNanoseconds(double columns, double rows);

/// One block column of dimension b in a leaf subtree, with `below` blocks under the diagonal.
double leafColumnNanoseconds(int b, double below);

/// Keeping and clearing the update matrix of a leaf subtree with `rows` scalars outside.
double leafUpdateNanoseconds(double rows);

}  // namespace quiver::detail
