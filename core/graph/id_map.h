#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace quiver {

/// Where an element lives: the pool of its type and its slot there.
struct ElementLocation {
  std::int32_t type = -1;
  std::int32_t slot = -1;
  bool valid() const { return type >= 0; }
};

/// From ids ≥ 0 to locations. Ids that are nearly dense cost one array access, others a hash look-up.
class IdMap {
 public:
  ElementLocation find(std::int64_t id) const {
    if (id >= 0 && id < static_cast<std::int64_t>(dense_.size())) {
      const ElementLocation location = dense_[static_cast<std::size_t>(id)];
      if (location.valid() || sparse_.empty()) return location;
    }
    if (sparse_.empty()) return {};
    const auto it = sparse_.find(id);
    return it == sparse_.end() ? ElementLocation{} : it->second;
  }

  void insert(std::int64_t id, ElementLocation location) {
    ++size_;
    if (id < 1024 + 4 * size_) {
      if (id >= static_cast<std::int64_t>(dense_.size())) dense_.resize(static_cast<std::size_t>(id + 1 + size_ / 2));
      dense_[static_cast<std::size_t>(id)] = location;
    } else {
      sparse_.emplace(id, location);
    }
  }

  void erase(std::int64_t id) {
    if (!find(id).valid()) return;
    --size_;
    if (id < static_cast<std::int64_t>(dense_.size()) && dense_[static_cast<std::size_t>(id)].valid()) {
      dense_[static_cast<std::size_t>(id)] = {};
    } else {
      sparse_.erase(id);
    }
  }

  std::int64_t size() const { return size_; }

 private:
  std::vector<ElementLocation> dense_;
  std::unordered_map<std::int64_t, ElementLocation> sparse_;
  std::int64_t size_ = 0;
};

}  // namespace quiver
