#include "factorization/cholmod_reference.h"

#include <cholmod.h>

#include <algorithm>

#include <quiver/core/util/error.h>
#include <quiver/solvers/backends/scalar_columns.h>

namespace quiver::bench {

struct CholmodReference::State {
  cholmod_common common{};
  cholmod_sparse* matrix = nullptr;
  cholmod_factor* factor = nullptr;
  cholmod_dense* solution = nullptr;
  cholmod_dense* work = nullptr;
  cholmod_dense* extra = nullptr;
};

CholmodReference::CholmodReference(const BlockMatrix& matrix, bool supernodal) : state_(std::make_unique<State>()) {
  State& s = *state_;
  cholmod_start(&s.common);
  s.common.print = 0;
  s.common.nmethods = 1;
  s.common.method[0].ordering = CHOLMOD_NATURAL;
  s.common.postorder = 1;
  s.common.supernodal = supernodal ? CHOLMOD_SUPERNODAL : CHOLMOD_SIMPLICIAL;
  s.common.final_ll = 1;
  const detail::ScalarColumns columns(matrix.pattern(), detail::ScalarColumns::Triangle::lower);
  const auto n = static_cast<std::size_t>(columns.size());
  s.matrix = cholmod_allocate_sparse(n, n, columns.rows().size(), 1, 1, -1, CHOLMOD_REAL, &s.common);
  std::ranges::copy(columns.columns(), static_cast<int*>(s.matrix->p));
  std::ranges::copy(columns.rows(), static_cast<int*>(s.matrix->i));
  columns.load(matrix, {}, static_cast<double*>(s.matrix->x));
  s.factor = cholmod_analyze(s.matrix, &s.common);
}

CholmodReference::CholmodReference(CholmodReference&&) noexcept = default;

CholmodReference::~CholmodReference() {
  if (!state_) return;
  State& s = *state_;
  cholmod_free_dense(&s.solution, &s.common);
  cholmod_free_dense(&s.work, &s.common);
  cholmod_free_dense(&s.extra, &s.common);
  cholmod_free_factor(&s.factor, &s.common);
  cholmod_free_sparse(&s.matrix, &s.common);
  cholmod_finish(&s.common);
}

void CholmodReference::factorize() {
  cholmod_factorize(state_->matrix, state_->factor, &state_->common);
  if (state_->common.status != CHOLMOD_OK) throw Error("cholmod: status " + std::to_string(state_->common.status));
}

void CholmodReference::solve(double* x) {
  State& s = *state_;
  cholmod_dense b{};
  b.nrow = b.d = b.nzmax = s.factor->n;
  b.ncol = 1;
  b.x = x;
  b.xtype = CHOLMOD_REAL;
  b.dtype = CHOLMOD_DOUBLE;
  cholmod_solve2(CHOLMOD_A, s.factor, &b, nullptr, &s.solution, nullptr, &s.work, &s.extra, &s.common);
  std::copy_n(static_cast<const double*>(s.solution->x), s.factor->n, x);
}

}  // namespace quiver::bench
