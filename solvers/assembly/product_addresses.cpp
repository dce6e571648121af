#include <quiver/solvers/assembly/product_addresses.h>

#include <quiver/core/problem/panel.h>

namespace quiver {

ProductAddresses::ProductAddresses(const Problem& problem, const AssemblyPlan& plan, int batch, int roles,
                                   const Memory& memory) {
  const auto padded =
      static_cast<std::size_t>((problem.batch(batch).size() + Panel::lanes - 1) / Panel::lanes * Panel::lanes);
  double* last = memory.nowhere;
  for (std::size_t p = 0; p < plan.pieces().size(); ++p) {
    if (plan.pieces()[p].batch == batch) last = memory.nowhere + static_cast<std::int64_t>(p) * memory.nowhereNumbers;
  }
  records_.assign(static_cast<std::size_t>(roles), std::vector<double*>(padded, last));
  blocks_.assign(static_cast<std::size_t>(roles * (roles - 1) / 2), std::vector<double*>(padded, last));
  flipped_.assign(blocks_.size(), std::vector<std::int64_t>(padded, 0));
  for (std::size_t p = 0; p < plan.pieces().size(); ++p) {
    const AssemblyPlan::Piece& piece = plan.pieces()[p];
    if (piece.batch != batch) continue;
    double* nowhere = memory.nowhere + static_cast<std::int64_t>(p) * memory.nowhereNumbers;
    for (int edge = piece.begin; edge < piece.end; ++edge) placeEdge(plan, batch, edge, nowhere, memory);
  }
  for (const auto& array : records_) recordArrays_.push_back(array.data());
  for (const auto& array : blocks_) blockArrays_.push_back(array.data());
  for (const auto& array : flipped_) flippedArrays_.push_back(array.data());
}

void ProductAddresses::placeEdge(const AssemblyPlan& plan, int batch, int edge, double* nowhere, const Memory& memory) {
  const auto at = static_cast<std::size_t>(edge);
  for (std::size_t role = 0; role < records_.size(); ++role) {
    const std::int64_t offset = plan.record(batch, edge, static_cast<int>(role));
    records_[role][at] = offset < 0 ? nowhere : memory.records + offset;
  }
  for (std::size_t pair = 0; pair < blocks_.size(); ++pair) {
    const AssemblyPlan::Destination& to = plan.pairs(batch, edge)[pair];
    blocks_[pair][at] = to.offset < 0 ? nowhere : (to.shared ? memory.shared : memory.matrix) + to.offset;
    flipped_[pair][at] = to.transposed ? -1 : 0;
  }
}

}  // namespace quiver
