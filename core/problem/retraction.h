#pragma once

#include <concepts>
#include <cstdint>

#include <quiver/core/problem/edge_functions.h>
#include <quiver/core/problem/lane_records.h>
#include <quiver/geometry/scalar/isa.h>

namespace quiver {

/// Vertices of one type and one dimension that are moved together: out = x ⊞ delta.
struct Retraction {
  /// Where the record of each vertex begins in `from` and in `to`.
  const std::int64_t* records = nullptr;
  int count = 0;
  int dimension = 0;
  const double* from = nullptr;
  /// count × dimension numbers.
  const double* delta = nullptr;
  double* to = nullptr;
};

namespace detail {

/// Whether a vertex type's oplus takes eight vertices side by side: the type says so by `lanes = true`.
template <typename V>
constexpr bool retractsInLanes() {
  if constexpr (requires {
                  { V::lanes } -> std::convertible_to<bool>;
                }) {
    using L = Lanes<isa::Avx512>;
    static_assert(
        !V::lanes || requires(const typename Packing<typename V::Estimate>::template Rebind<L>& x,
                              const Vector<L, V::dimension>& delta) { V::oplus(x, delta); },
        "lanes = true needs an oplus that is a template over the scalar");
    return V::lanes;
  } else {
    return false;
  }
}

template <typename V>
inline void retractOne(const double* x, const double* delta, double* out) {
  using Estimate = typename V::Estimate;
  const Vector<double, V::dimension> step = Eigen::Map<const Vector<double, V::dimension>>(delta);
  const Estimate moved = V::oplus(Packing<Estimate>::template load<double>(x), step);
  Packing<Estimate>::store(moved, out);
}

/// Eight vertices at a time; places beyond the last repeat it. Inlined into the caller, which carries the instruction
/// set.
template <typename V, typename L>
inline void retractLanes(const Retraction& retraction) {
  constexpr int dimension = V::dimension;
  constexpr int size = Packing<typename V::Estimate>::size;
  for (int begin = 0; begin < retraction.count; begin += L::width) {
    const double* from[L::width];
    double* to[L::width];
    const double* steps[L::width];
    for (int i = 0; i < L::width; ++i) {
      const int vertex = begin + i < retraction.count ? begin + i : retraction.count - 1;
      from[i] = retraction.from + retraction.records[vertex];
      to[i] = retraction.to + retraction.records[vertex];
      steps[i] = retraction.delta + std::int64_t{vertex} * dimension;
    }
    L delta[dimension];
    if (begin + L::width + 8 / dimension < retraction.count) {
      loadRecords<dimension>(steps, delta);
    } else {  // loadRecords may read up to eight numbers on
      for (int k = 0; k < dimension; ++k) {
        for (int i = 0; i < L::width; ++i) delta[k].v[i] = steps[i][k];
      }
    }
    L numbers[size];
    loadRecords<size>(from, numbers);
    const auto x = Packing<typename V::Estimate>::template load<L>(numbers);
    Vector<L, dimension> step;
    for (int k = 0; k < dimension; ++k) step[k] = delta[k];
    const typename Packing<typename V::Estimate>::template Rebind<L> moved = V::oplus(x, step);
    Packing<typename V::Estimate>::store(moved, numbers);
    storeRecords<size>(numbers, to);
  }
}

template <typename V>
QUIVER_BATCH_LOOP_AVX512 void retractAvx512(const Retraction& retraction) {
  retractLanes<V, Lanes<isa::Avx512>>(retraction);
}
template <typename V>
QUIVER_BATCH_LOOP_AVX2 void retractAvx2(const Retraction& retraction) {
  retractLanes<V, Lanes<isa::Avx2>>(retraction);
}

/// Vertices of a compile-time dimension.
template <typename V>
void retractAll(const Retraction& retraction) {
  if constexpr (retractsInLanes<V>()) {
    const InstructionSet set = detectInstructionSet();
    if constexpr (QUIVER_EVERY_INSTRUCTION_SET) {
      if (set == InstructionSet::avx512) return retractAvx512<V>(retraction);
    }
    if (set != InstructionSet::generic) return retractAvx2<V>(retraction);
  }
  for (int i = 0; i < retraction.count; ++i) {
    retractOne<V>(retraction.from + retraction.records[i], retraction.delta + i * V::dimension,
                  retraction.to + retraction.records[i]);
  }
}

}  // namespace detail
}  // namespace quiver
