#include <quiver/solvers/assembly/assembly_plan.h>

#include <algorithm>

#include <quiver/core/problem/panel.h>
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

void AssemblyPlan::cutPieces(const Problem& problem) {
  for (int b = 0; b < problem.batches(); ++b) {
    const int size = problem.batch(b).size();
    // Edges that run one by one may cost anything: threads are to share them even if they are few.
    const int least = problem.batch(b).rowBytes() > 0 ? 1024 : Panel::capacity;
    const int piece = (std::clamp(size / 32, least, 16384) + 15) / 16 * 16;
    for (int begin = 0; begin < size; begin += piece)
      pieces_.push_back({b, begin, std::min(size, begin + piece), 0, 0, 0});
  }
}

void AssemblyPlan::placeRecords(const Problem& problem) {
  cutPieces(problem);
  for (int b = 0; b < problem.batches(); ++b) {
    if (problem.batch(b).uniform())
      batches_[static_cast<std::size_t>(b)].perEdge = static_cast<int>(problem.batch(b).largestShape().columns.size());
  }
  std::vector<int> lastPiece(static_cast<std::size_t>(problem.variables()), -1);
  std::vector<std::int64_t> lastRecord(lastPiece.size(), -1);
  std::vector<std::pair<int, std::int64_t>> owners;  // variable and record, in the order of pieces
  for (std::size_t p = 0; p < pieces_.size(); ++p) {
    Piece& piece = pieces_[p];
    const EdgeBatch& batch = problem.batch(piece.batch);
    Roles& roles = batches_[static_cast<std::size_t>(piece.batch)];
    if (piece.begin == 0) roles.firstRecord = static_cast<std::int64_t>(records_.size());
    piece.recordBegin = recordNumbers_;
    piece.firstGroup = groupEnds_.size();
    for (int i = piece.begin; i < piece.end; ++i) {
      if (roles.perEdge < 0)
        roles.recordBegin.push_back(static_cast<std::int64_t>(records_.size()) - roles.firstRecord);
      for (const std::int32_t slot : batch.slots(i)) {
        const int variable = problem.variableOfSlot(slot);
        if (variable < 0) {
          records_.push_back(-1);
          continue;
        }
        const auto v = static_cast<std::size_t>(variable);
        if (lastPiece[v] != static_cast<int>(p)) {
          lastPiece[v] = static_cast<int>(p);
          lastRecord[v] = recordNumbers_;
          // Whole lines: adding to a record must not cross one.
          recordNumbers_ += (LaneProducts::paddedSize(problem.dimension(variable)) + 7) / 8 * 8;
          owners.emplace_back(variable, lastRecord[v]);
        }
        records_.push_back(lastRecord[v]);
      }
      if ((i + 1 - piece.begin) % Panel::capacity == 0 || i + 1 == piece.end) groupEnds_.push_back(recordNumbers_);
    }
    piece.recordEnd = recordNumbers_;
  }
  gatherRecords(problem, owners);
}

void AssemblyPlan::gatherRecords(const Problem& problem, const std::vector<std::pair<int, std::int64_t>>& owners) {
  gatherBegin_.assign(static_cast<std::size_t>(problem.variables()) + 1, 0);
  for (const auto& [variable, record] : owners) ++gatherBegin_[static_cast<std::size_t>(variable) + 1];
  for (std::size_t v = 1; v < gatherBegin_.size(); ++v) gatherBegin_[v] += gatherBegin_[v - 1];
  gather_.resize(owners.size());
  std::vector<std::int64_t> next(gatherBegin_.begin(), gatherBegin_.end() - 1);
  for (const auto& [variable, record] : owners) {
    gather_[static_cast<std::size_t>(next[static_cast<std::size_t>(variable)]++)] = record;
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
