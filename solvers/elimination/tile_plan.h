#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <quiver/solvers/block/block_matrix.h>
#include <quiver/solvers/elimination/elimination_plan.h>
#include <quiver/solvers/elimination/kernels/kernel_table.h>

namespace quiver {

/// Where the elimination of points writes its records, and which products of records go to which block of the reduced
/// matrix S.
///
/// A tile is a run of groups of one dimension whose records (one for every pair of a point and a kept vertex) fit into
/// the second cache together. In a tile every block of S that its points touch has a list of pairs of records, so each
/// block is visited once a tile and by one thread.
class TilePlan {
 public:
  TilePlan() = default;
  /// `matrix` is S in elimination order, `position[kept]` a vertex's block in it. With `diagonalOnly` products
  /// of different kept vertices are left out. O(Σ k² over points with k neighbours).
  TilePlan(const EliminationPlan& plan, const BlockMatrix& matrix, std::span<const int> position, bool diagonalOnly);

  /// Place of an incidence that has no record: a fixed vertex, an empty lane.
  static constexpr std::uint16_t nowhere = 0xffff;

  struct Block {
    std::int64_t target;  // offset in the values of S
    std::int64_t pairs;   // first of its pairs; they end where the next block's begin
    std::int32_t row;     // kept vertices
    std::int32_t column;
  };
  /// A record that several edges add to, and its lane's point.
  struct SharedRecord {
    std::uint16_t place;
    std::uint16_t lane;
    std::int32_t kept;
  };
  struct Tile {
    std::int32_t groupBegin;
    std::int32_t groupEnd;
    std::int32_t dimension;
    std::int64_t blockBegin;
    std::int64_t blockEnd;
  };

  const std::vector<Tile>& tiles() const { return tiles_; }
  const std::vector<Block>& blocks() const { return blocks_; }
  const std::vector<detail::RecordPair>& pairs() const { return pairs_; }
  /// Places of a row's incidences in the tile's memory, in units of 8 doubles; parallel to the plan's incidences.
  const std::uint16_t* places(const EliminationPlan::Row& row) const { return places_.data() + row.incidences; }
  /// Whether a kept role of a row adds to records instead of writing them.
  bool adds(std::int64_t row, int keptRole) const {
    return adds_[static_cast<std::size_t>(row)] >> (keptRole < 31 ? keptRole : 31) & 1;
  }
  std::span<const SharedRecord> sharedRecords(int group) const {
    const auto begin = static_cast<std::size_t>(sharedBegin_[static_cast<std::size_t>(group)]);
    return {shared_.data() + begin,
            static_cast<std::size_t>(sharedBegin_[static_cast<std::size_t>(group) + 1]) - begin};
  }
  /// Doubles of the largest tile.
  std::int64_t tileNumbers() const { return tileNumbers_; }
  std::int64_t bytes() const;

  /// Units of 8 doubles that the records of one point may take; a point with more must not be eliminated.
  static constexpr int mostUnits = 4096;

 private:
  class Builder;
  std::vector<Tile> tiles_;
  std::vector<Block> blocks_;
  std::vector<detail::RecordPair> pairs_;
  std::vector<std::uint16_t> places_;
  std::vector<std::uint32_t> adds_;
  std::vector<SharedRecord> shared_;
  std::vector<std::int64_t> sharedBegin_;
  std::int64_t tileNumbers_ = 0;
};

}  // namespace quiver
