#include <quiver/solvers/elimination/tile_plan.h>

#include <algorithm>
#include <array>

namespace quiver {
namespace {

constexpr int lanes = Panel::lanes;
/// Units of 8 doubles after which a tile is closed: 384 KB, so that records and blocks stay in a second cache of 1 MB.
constexpr int tileUnits = 6144;
/// Up to so many kept vertices entries of S are found in a table of all pairs.
constexpr int mostTabled = 3000;

}  // namespace

class TilePlan::Builder {
 public:
  Builder(TilePlan& out, const EliminationPlan& plan, const BlockPattern& pattern, std::span<const int> position,
          bool diagonalOnly)
      : out_(out),
        plan_(plan),
        pattern_(pattern),
        position_(position),
        diagonalOnly_(diagonalOnly),
        owner_(static_cast<std::size_t>(plan.kept()), -1),
        visits_(static_cast<std::size_t>(plan.kept())),
        place_(static_cast<std::size_t>(plan.kept())),
        count_(static_cast<std::size_t>(pattern.entries()), 0) {
    if (diagonalOnly_ || pattern.blocks() > mostTabled) return;
    const auto n = static_cast<std::size_t>(pattern.blocks());
    table_.resize(n * (n + 1) / 2, -1);
    for (int column = 0; column < pattern.blocks(); ++column) {
      for (std::int64_t k = pattern.columnBegin(column); k < pattern.columnEnd(column); ++k)
        table_[tableIndex(pattern.row(k), column)] = static_cast<std::int32_t>(k);
    }
  }

  void build() {
    out_.places_.assign(plan_.incidences().size(), nowhere);
    out_.adds_.assign(plan_.rows().size(), 0);
    out_.sharedBegin_.push_back(0);
    int begin = 0;
    int units = 0;
    for (int g = 0; g < plan_.pointGroups(); ++g) {
      const EliminationPlan::Group& group = plan_.groups()[static_cast<std::size_t>(g)];
      const int dimension = plan_.groups()[static_cast<std::size_t>(begin)].dimension;
      if (g > begin && (units >= tileUnits || group.dimension != dimension)) {
        closeTile(begin, g, units);
        begin = g;
        units = 0;
      }
      placeRecords(g, units);
      out_.sharedBegin_.push_back(static_cast<std::int64_t>(out_.shared_.size()));
    }
    if (begin < plan_.pointGroups()) closeTile(begin, plan_.pointGroups(), units);
    out_.blocks_.push_back({-1, static_cast<std::int64_t>(out_.pairs_.size()), -1, -1});
  }

 private:
  struct Incidence {
    std::int32_t kept;
    std::uint16_t place;
  };
  struct Product {
    std::int64_t entry;
    detail::RecordPair pair;
  };

  std::size_t tableIndex(int row, int column) const {
    return static_cast<std::size_t>(row) * (static_cast<std::size_t>(row) + 1) / 2 + static_cast<std::size_t>(column);
  }
  std::int64_t entryOf(int row, int column) const {
    return table_.empty() ? pattern_.find(row, column) : table_[tableIndex(row, column)];
  }

  template <typename Visit>
  void forEachIncidence(int g, const Visit& visit) {
    const EliminationPlan::Group& group = plan_.groups()[static_cast<std::size_t>(g)];
    for (int r = group.rowBegin; r < group.rowEnd; ++r) {
      const EliminationPlan::Row& row = plan_.rows()[static_cast<std::size_t>(r)];
      const RowKind& kind = plan_.kinds()[static_cast<std::size_t>(row.kind)];
      for (int role = 0; role < static_cast<int>(kind.keptRoles.size()); ++role) {
        for (int lane = 0; lane < lanes; ++lane) {
          const std::int64_t at = row.incidences + role * lanes + lane;
          const std::int32_t kept = plan_.incidences()[static_cast<std::size_t>(at)];
          if (kept >= 0) visit(r, role, lane, kept, static_cast<std::size_t>(at), kind.dimension(role));
        }
      }
    }
  }

  /// Gives every pair of a point and a kept vertex a place; those met twice become shared.
  void placeRecords(int g, int& units) {
    const EliminationPlan::Group& group = plan_.groups()[static_cast<std::size_t>(g)];
    points_.resize(points_.size() + lanes);
    const std::size_t first = points_.size() - lanes;
    // A vertex may be met by several lanes, so lanes are told apart one after the other.
    for (int lane = 0; lane < lanes; ++lane) {
      const std::int32_t token = token_++;
      auto& own = points_[first + static_cast<std::size_t>(lane)];
      const auto begin = own.size();
      for (int r = group.rowBegin; r < group.rowEnd; ++r) {
        const EliminationPlan::Row& row = plan_.rows()[static_cast<std::size_t>(r)];
        const RowKind& kind = plan_.kinds()[static_cast<std::size_t>(row.kind)];
        for (int role = 0; role < static_cast<int>(kind.keptRoles.size()); ++role) {
          const auto at = static_cast<std::size_t>(row.incidences + role * lanes + lane);
          const std::int32_t kept = plan_.incidences()[at];
          if (kept < 0) continue;
          const auto k = static_cast<std::size_t>(kept);
          if (owner_[k] != token) {
            owner_[k] = token;
            visits_[k] = 0;
            place_[k] = static_cast<std::uint16_t>(units);
            units += detail::recordSize(kind.dimension(role), group.dimension) / 8;
            own.push_back({kept, place_[k]});
          }
          ++visits_[k];
          out_.places_[at] = place_[k];
        }
      }
      for (std::size_t i = begin; i < own.size(); ++i) {
        if (visits_[static_cast<std::size_t>(own[i].kept)] > 1)
          out_.shared_.push_back({own[i].place, static_cast<std::uint16_t>(lane), own[i].kept});
      }
    }
    markShared(g);
  }

  /// A row whose role meets a shared record in any lane adds in all of them, so all its records are prepared.
  void markShared(int g) {
    const auto begin = static_cast<std::size_t>(out_.sharedBegin_.back());
    if (begin == out_.shared_.size()) return;
    preparedPlaces_.clear();
    for (std::size_t i = begin; i < out_.shared_.size(); ++i) preparedPlaces_.push_back(out_.shared_[i].place);
    std::sort(preparedPlaces_.begin(), preparedPlaces_.end());
    const std::size_t shared = preparedPlaces_.size();
    const auto isShared = [&](std::uint16_t place) {
      return std::binary_search(preparedPlaces_.begin(), preparedPlaces_.begin() + static_cast<std::ptrdiff_t>(shared),
                                place);
    };
    forEachIncidence(g, [&](int r, int role, int, std::int32_t, std::size_t at, int) {
      if (isShared(out_.places_[at])) out_.adds_[static_cast<std::size_t>(r)] |= 1U << (role < 31 ? role : 31);
    });
    forEachIncidence(g, [&](int r, int role, int lane, std::int32_t kept, std::size_t at, int) {
      if (out_.adds(r, role) && !isShared(out_.places_[at]))
        out_.shared_.push_back({out_.places_[at], static_cast<std::uint16_t>(lane), kept});
    });
  }

  void closeTile(int begin, int end, int units) {
    products_.clear();
    for (const std::vector<Incidence>& own : points_) {
      for (std::size_t i = 0; i < own.size(); ++i) {
        for (std::size_t j = diagonalOnly_ ? i : 0; j <= i; ++j) {
          int row = position_[static_cast<std::size_t>(own[i].kept)];
          int column = position_[static_cast<std::size_t>(own[j].kept)];
          detail::RecordPair pair{own[i].place, own[j].place};
          if (row < column) {
            std::swap(row, column);
            std::swap(pair.row, pair.column);
          }
          products_.push_back({row == column ? pattern_.columnBegin(column) : entryOf(row, column), pair});
        }
      }
    }
    Tile tile{begin, end, plan_.groups()[static_cast<std::size_t>(begin)].dimension,
              static_cast<std::int64_t>(out_.blocks_.size()), 0};
    sortProducts();
    tile.blockEnd = static_cast<std::int64_t>(out_.blocks_.size());
    out_.tiles_.push_back(tile);
    out_.tileNumbers_ = std::max(out_.tileNumbers_, std::int64_t{units} * 8);
    points_.clear();
  }

  /// Counting sort of the tile's products by entry.
  void sortProducts() {
    touched_.clear();
    for (const Product& product : products_) {
      if (count_[static_cast<std::size_t>(product.entry)]++ == 0) touched_.push_back(product.entry);
    }
    std::sort(touched_.begin(), touched_.end());
    auto next = static_cast<std::int64_t>(out_.pairs_.size());
    out_.pairs_.resize(out_.pairs_.size() + products_.size());
    for (const std::int64_t entry : touched_) {
      out_.blocks_.push_back({entry, next, 0, 0});
      const std::int64_t own = count_[static_cast<std::size_t>(entry)];
      count_[static_cast<std::size_t>(entry)] = next;
      next += own;
    }
    for (const Product& product : products_)
      out_.pairs_[static_cast<std::size_t>(count_[static_cast<std::size_t>(product.entry)]++)] = product.pair;
    for (const std::int64_t entry : touched_) count_[static_cast<std::size_t>(entry)] = 0;
  }

  TilePlan& out_;
  const EliminationPlan& plan_;
  const BlockPattern& pattern_;
  std::span<const int> position_;
  bool diagonalOnly_;
  std::vector<std::int32_t> table_;
  std::vector<std::int32_t> owner_;
  std::vector<std::int32_t> visits_;
  std::vector<std::uint16_t> place_;
  std::int32_t token_ = 0;
  std::vector<std::vector<Incidence>> points_;
  std::vector<Product> products_;
  std::vector<std::int64_t> count_;
  std::vector<std::int64_t> touched_;
  std::vector<std::uint16_t> preparedPlaces_;
};

TilePlan::TilePlan(const EliminationPlan& plan, const BlockMatrix& matrix, std::span<const int> position,
                   bool diagonalOnly) {
  const BlockPattern& pattern = matrix.pattern();
  Builder(*this, plan, pattern, position, diagonalOnly).build();
  tiles_.shrink_to_fit();
  blocks_.shrink_to_fit();
  pairs_.shrink_to_fit();
  shared_.shrink_to_fit();
  std::vector<int> keptAt(position.size());
  for (std::size_t kept = 0; kept < position.size(); ++kept)
    keptAt[static_cast<std::size_t>(position[kept])] = static_cast<int>(kept);
  std::vector<std::int32_t> columnOf(static_cast<std::size_t>(pattern.entries()));
  for (int column = 0; column < pattern.blocks(); ++column) {
    for (std::int64_t k = pattern.columnBegin(column); k < pattern.columnEnd(column); ++k)
      columnOf[static_cast<std::size_t>(k)] = column;
  }
  for (std::size_t b = 0; b + 1 < blocks_.size(); ++b) {
    Block& block = blocks_[b];
    const std::int64_t entry = block.target;  // so far
    block.target = matrix.offset(entry);
    block.row = keptAt[static_cast<std::size_t>(pattern.row(entry))];
    block.column = keptAt[static_cast<std::size_t>(columnOf[static_cast<std::size_t>(entry)])];
  }
}

std::int64_t TilePlan::bytes() const {
  return static_cast<std::int64_t>(tiles_.size() * sizeof(Tile) + blocks_.size() * sizeof(Block) +
                                   pairs_.size() * sizeof(detail::RecordPair) + places_.size() * 2 + adds_.size() * 4 +
                                   shared_.size() * sizeof(SharedRecord) + sharedBegin_.size() * 8);
}

}  // namespace quiver
