#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <quiver/core/problem/problem.h>
#include <quiver/solvers/block/block_pattern.h>

namespace quiver {

/// Edges of one batch whose eliminated vertex has the same role and that have the same shape; role −1 means that no
/// vertex is eliminated.
struct RowKind {
  int batch = 0;
  int role = -1;
  EdgeShape shape;
  /// The other roles, ascending.
  std::vector<int> keptRoles;

  int keptPairs() const { return static_cast<int>(keptRoles.size() * (keptRoles.size() - 1) / 2); }
  int dimension(int keptRole) const {
    return shape.columns[static_cast<std::size_t>(keptRoles[static_cast<std::size_t>(keptRole)])];
  }
};

/// Structure of point elimination: in which order, eight at a time, edges are linearised, and where what they yield
/// goes. Depends on the problem and on the eliminated set alone. "Point" stands for any eliminated vertex.
///
/// Eight points of one dimension and of like edges make a group; edge j of kind q of the eight is a row, lane i its
/// point. Points that see the same kept vertices lie near each other. Edges without a point follow in rows and groups
/// of their own, of dimension 0.
class EliminationPlan {
 public:
  EliminationPlan() = default;
  /// `eliminated[variable]`; no edge may join two such variables. O(edges · roles + points log points).
  EliminationPlan(const Problem& problem, std::span<const char> eliminated);

  struct Row {
    std::int32_t kind;
    /// Bit i: lane i holds an edge; others repeat one.
    std::uint32_t lanes;
    /// First entry in the lists of incidences: 8 for each kept role.
    std::int64_t incidences;
  };
  struct Group {
    std::int32_t dimension;
    std::int32_t rowBegin;
    std::int32_t rowEnd;
    /// Bit i: lane i holds a point.
    std::uint32_t lanes;
    /// First number of its sums in the memory of all points' sums.
    std::int64_t sums;
    /// Variables; −1 where there is none.
    std::array<std::int32_t, 8> points;
  };

  const std::vector<RowKind>& kinds() const { return kinds_; }
  const std::vector<Row>& rows() const { return rows_; }
  const std::vector<Group>& groups() const { return groups_; }
  /// Groups with points come first.
  int pointGroups() const { return pointGroups_; }
  /// Edges of a row, in its batch: 8 numbers.
  const std::int32_t* edges(std::int64_t row) const { return edges_.data() + row * 8; }
  std::int64_t sumNumbers() const { return sumNumbers_; }
  std::int64_t points() const { return points_; }

  int kept() const { return static_cast<int>(keptVariables_.size()); }
  int keptVariable(int kept) const { return keptVariables_[static_cast<std::size_t>(kept)]; }
  /// −1 if the variable is eliminated.
  int keptOf(int variable) const { return keptOf_[static_cast<std::size_t>(variable)]; }
  const BlockLayout& keptLayout() const { return keptLayout_; }
  /// Kept vertices of a row's incidences, −1 for a fixed vertex or an empty lane.
  const std::vector<std::int32_t>& incidences() const { return incidences_; }

  /// Bytes of the lists.
  std::int64_t bytes() const;

 private:
  struct Entry {
    std::int32_t kind;
    std::int32_t edge;
  };
  /// Edges by point, and edges of every kind without one.
  struct Incidence {
    std::vector<std::int64_t> begin;
    std::vector<Entry> entries;
    std::vector<std::vector<std::int32_t>> free;
    std::vector<std::int32_t> points;
  };
  void numberKept(const Problem& problem, std::span<const char> eliminated);
  int kindOf(const Problem& problem, int batch, int edge, int role);
  Incidence collect(const Problem& problem, std::span<const char> eliminated);
  std::vector<std::int32_t> orderPoints(const Problem& problem, const Incidence& incidence) const;
  void addGroup(const Problem& problem, const Incidence& incidence, std::span<const std::int32_t> points);
  void addFreeRows(const Problem& problem, const Incidence& incidence);
  void addRow(const Problem& problem, int kind, const std::array<std::int32_t, 8>& edges);

  std::vector<RowKind> kinds_;
  std::vector<std::vector<int>> kindsOfBatch_;
  std::vector<Row> rows_;
  std::vector<Group> groups_;
  int pointGroups_ = 0;
  std::vector<std::int32_t> edges_;
  std::vector<std::int32_t> incidences_;
  std::int64_t sumNumbers_ = 0;
  std::int64_t points_ = 0;
  std::vector<int> keptVariables_;
  std::vector<int> keptOf_;
  BlockLayout keptLayout_;
};

}  // namespace quiver
