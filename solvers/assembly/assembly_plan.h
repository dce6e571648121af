#pragma once

#include <cstdint>
#include <vector>

#include <quiver/core/problem/problem.h>
#include <quiver/solvers/block/block_matrix.h>

namespace quiver {

/// Where the numbers of every edge's linearisation go: structure of the assembly of H and g, made once.
///
/// Edges are cut into pieces, whose number depends on the problem alone. In a piece, every vertex that its edges touch
/// has one record (the upper triangle of Σ JᵀJ and Σ Jᵀr over the piece's edges, added edge by edge); afterwards every
/// vertex adds its records in the order of pieces. So there are hardly more records than vertices, and they stay in the
/// cache while a piece is worked on. A pair of free roles gives one block AᵀB: a block that only one edge writes goes
/// straight to H; blocks that several edges share are added in the order of edges.
class AssemblyPlan {
 public:
  AssemblyPlan() = default;
  /// `matrix` fixes the layout of H in elimination order; position[variable] is its block there.
  AssemblyPlan(const Problem& problem, const BlockMatrix& matrix, const std::vector<int>& position);

  /// Pairs of variables that edges join, for the pattern of H.
  static std::vector<std::pair<int, int>> variablePairs(const Problem& problem);

  /// A run of edges of one batch, the unit of parallel work, and the range of the record memory that is its own.
  struct Piece {
    int batch;
    int begin;
    int end;
    std::int64_t recordBegin;
    std::int64_t recordEnd;
    std::size_t firstGroup;  // of recordEndOf
  };
  const std::vector<Piece>& pieces() const { return pieces_; }

  /// The record of role `role` of edge i of batch b starts at number recordBegin(b, i, role) of the record memory; −1
  /// for a fixed vertex.
  std::int64_t record(int batch, int edge, int role) const {
    const Roles& roles = batches_[static_cast<std::size_t>(batch)];
    return records_[static_cast<std::size_t>(roles.firstRecord + roles.recordsBefore(edge) + role)];
  }
  std::int64_t recordNumbers() const { return recordNumbers_; }
  /// Edges are linearised in groups of Panel::capacity. Records come in the order in which edges meet them: those that
  /// the groups of a piece up to `group` touch end here.
  std::int64_t recordEndOf(const Piece& piece, int group) const {
    return groupEnds_[piece.firstGroup + static_cast<std::size_t>(group)];
  }

  /// Where a pair of roles goes. `transposed`: the block of H is BᵀA, not AᵀB.
  struct Destination {
    /// Offset in H's values, or in the memory of shared blocks if `shared`; −1: nowhere, one of the two is fixed.
    std::int64_t offset = -1;
    bool transposed = false;
    bool shared = false;
  };
  /// Pairs of an edge: (0,1), (0,2), (1,2), (0,3), … in this order.
  const Destination* pairs(int batch, int edge) const {
    const Roles& roles = batches_[static_cast<std::size_t>(batch)];
    return destinations_.data() + roles.firstPair + roles.pairsBefore(edge);
  }
  std::int64_t sharedNumbers() const { return sharedNumbers_; }

  /// Records of a variable: records(gatherBegin(v)) … in the order of addition.
  std::int64_t gatherBegin(int variable) const { return gatherBegin_[static_cast<std::size_t>(variable)]; }
  std::int64_t gathered(std::int64_t i) const { return gather_[static_cast<std::size_t>(i)]; }

  /// Shared blocks: their place in H, their size, and the contributions to add.
  struct SharedBlock {
    std::int64_t offset;
    int numbers;
    std::int64_t begin;
    std::int64_t end;
  };
  const std::vector<SharedBlock>& sharedBlocks() const { return sharedBlocks_; }
  std::int64_t sharedContribution(std::int64_t i) const { return sharedContributions_[static_cast<std::size_t>(i)]; }

 private:
  struct Roles {
    int perEdge = -1;  // −1: differs, see `begin`
    std::int64_t firstRecord = 0;
    std::int64_t firstPair = 0;
    std::vector<std::int64_t> recordBegin;
    std::vector<std::int64_t> pairBegin;
    std::int64_t recordsBefore(int edge) const {
      return perEdge >= 0 ? std::int64_t{edge} * perEdge : recordBegin[static_cast<std::size_t>(edge)];
    }
    std::int64_t pairsBefore(int edge) const {
      return perEdge >= 0 ? std::int64_t{edge} * (perEdge * (perEdge - 1) / 2)
                          : pairBegin[static_cast<std::size_t>(edge)];
    }
  };
  void cutPieces(const Problem& problem);
  void placeRecords(const Problem& problem);
  void gatherRecords(const Problem& problem, const std::vector<std::pair<int, std::int64_t>>& owners);
  void placePairs(const Problem& problem, const BlockMatrix& matrix, const std::vector<int>& position);
  void shareBlocks(const BlockMatrix& matrix, const std::vector<std::int64_t>& entryOfPair);

  std::vector<Piece> pieces_;
  std::vector<Roles> batches_;
  std::vector<std::int64_t> records_;
  std::int64_t recordNumbers_ = 0;
  std::vector<std::int64_t> groupEnds_;
  std::vector<Destination> destinations_;
  std::int64_t sharedNumbers_ = 0;
  std::vector<std::int64_t> gatherBegin_;
  std::vector<std::int64_t> gather_;
  std::vector<SharedBlock> sharedBlocks_;
  std::vector<std::int64_t> sharedContributions_;
};

}  // namespace quiver
