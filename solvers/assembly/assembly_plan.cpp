#include <quiver/solvers/assembly/assembly_plan.h>

#include <algorithm>

#include <quiver/solvers/assembly/lane_products.h>

namespace quiver {

AssemblyPlan::AssemblyPlan(const Problem& problem, const BlockMatrix& matrix, const std::vector<int>& position) {
  batches_.resize(static_cast<std::size_t>(problem.batches()));
  placeRecords(problem);
  placePairs(problem, matrix, position);
}

std::vector<std::pair<int, int>> AssemblyPlan::variablePairs(const Problem& problem) {
  std::vector<std::pair<int, int>> pairs;
  for (int b = 0; b < problem.batches(); ++b) {
    const EdgeBatch& batch = problem.batch(b);
    for (int i = 0; i < batch.size(); ++i) {
      const auto slots = batch.slots(i);
      for (std::size_t second = 1; second < slots.size(); ++second) {
        const int v = problem.variableOfSlot(slots[second]);
        if (v < 0) continue;
        for (std::size_t first = 0; first < second; ++first) {
          const int u = problem.variableOfSlot(slots[first]);
          if (u >= 0) pairs.emplace_back(u, v);
        }
      }
    }
  }
  return pairs;
}

void AssemblyPlan::placeRecords(const Problem& problem) {
  gatherBegin_.assign(static_cast<std::size_t>(problem.variables()) + 1, 0);
  for (int b = 0; b < problem.batches(); ++b) {
    const EdgeBatch& batch = problem.batch(b);
    Roles& roles = batches_[static_cast<std::size_t>(b)];
    roles.firstRecord = static_cast<std::int64_t>(records_.size());
    if (batch.uniform()) roles.perEdge = static_cast<int>(batch.largestShape().columns.size());
    for (int i = 0; i < batch.size(); ++i) {
      if (!batch.uniform()) {
        roles.recordBegin.push_back(static_cast<std::int64_t>(records_.size()) - roles.firstRecord);
      }
      for (const std::int32_t slot : batch.slots(i)) {
        const int variable = problem.variableOfSlot(slot);
        records_.push_back(variable < 0 ? -1 : recordNumbers_);
        if (variable < 0) continue;
        recordNumbers_ += (LaneProducts::squareSize(problem.dimension(variable)) + 7) / 8 * 8;
        ++gatherBegin_[static_cast<std::size_t>(variable) + 1];
      }
    }
  }
  for (std::size_t v = 1; v < gatherBegin_.size(); ++v) gatherBegin_[v] += gatherBegin_[v - 1];
  gather_.resize(static_cast<std::size_t>(gatherBegin_.back()));
  std::vector<std::int64_t> next(gatherBegin_.begin(), gatherBegin_.end() - 1);
  std::size_t at = 0;
  for (int b = 0; b < problem.batches(); ++b) {
    const EdgeBatch& batch = problem.batch(b);
    for (int i = 0; i < batch.size(); ++i) {
      for (const std::int32_t slot : batch.slots(i)) {
        const std::int64_t record = records_[at++];
        if (record >= 0)
          gather_[static_cast<std::size_t>(next[static_cast<std::size_t>(problem.variableOfSlot(slot))]++)] = record;
      }
    }
  }
}

void AssemblyPlan::placePairs(const Problem& problem, const BlockMatrix& matrix, const std::vector<int>& position) {
  std::vector<std::int64_t> entryOfPair;
  for (int b = 0; b < problem.batches(); ++b) {
    const EdgeBatch& batch = problem.batch(b);
    Roles& roles = batches_[static_cast<std::size_t>(b)];
    roles.firstPair = static_cast<std::int64_t>(destinations_.size());
    for (int i = 0; i < batch.size(); ++i) {
      if (roles.perEdge < 0)
        roles.pairBegin.push_back(static_cast<std::int64_t>(destinations_.size()) - roles.firstPair);
      const auto slots = batch.slots(i);
      for (std::size_t second = 1; second < slots.size(); ++second) {
        const int v = problem.variableOfSlot(slots[second]);
        for (std::size_t first = 0; first < second; ++first) {
          const int u = problem.variableOfSlot(slots[first]);
          Destination destination;
          std::int64_t entry = -1;
          if (u >= 0 && v >= 0) {
            const int row = position[static_cast<std::size_t>(u)];
            const int column = position[static_cast<std::size_t>(v)];
            destination.transposed = row < column;
            entry = matrix.pattern().find(std::max(row, column), std::min(row, column));
            destination.offset = matrix.offset(entry);
          }
          destinations_.push_back(destination);
          entryOfPair.push_back(entry);
        }
      }
    }
  }
  shareBlocks(matrix, entryOfPair);
}

void AssemblyPlan::shareBlocks(const BlockMatrix& matrix, const std::vector<std::int64_t>& entryOfPair) {
  std::vector<std::int32_t> writers(static_cast<std::size_t>(matrix.pattern().entries()), 0);
  for (const std::int64_t entry : entryOfPair) {
    if (entry >= 0) ++writers[static_cast<std::size_t>(entry)];
  }
  std::vector<std::int64_t> next(writers.size(), -1);
  for (std::size_t entry = 0; entry < writers.size(); ++entry) {
    if (writers[entry] < 2) continue;
    const std::int64_t begin = static_cast<std::int64_t>(sharedContributions_.size());
    const std::int64_t numbers =
        matrix.offset(static_cast<std::int64_t>(entry) + 1) - matrix.offset(static_cast<std::int64_t>(entry));
    sharedBlocks_.push_back(
        {matrix.offset(static_cast<std::int64_t>(entry)), static_cast<int>(numbers), begin, begin + writers[entry]});
    sharedContributions_.resize(sharedContributions_.size() + static_cast<std::size_t>(writers[entry]));
    next[entry] = begin;
  }
  if (sharedBlocks_.empty()) return;
  for (std::size_t pair = 0; pair < entryOfPair.size(); ++pair) {
    const std::int64_t entry = entryOfPair[pair];
    if (entry < 0 || next[static_cast<std::size_t>(entry)] < 0) continue;
    const std::int64_t numbers = matrix.offset(entry + 1) - matrix.offset(entry);
    destinations_[pair].shared = true;
    destinations_[pair].offset = sharedNumbers_;
    sharedContributions_[static_cast<std::size_t>(next[static_cast<std::size_t>(entry)]++)] = sharedNumbers_;
    sharedNumbers_ += (numbers + 7) / 8 * 8;
  }
}

}  // namespace quiver
