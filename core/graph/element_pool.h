#pragma once

#include <cstdint>
#include <memory>
#include <vector>

namespace quiver {

/// All elements of one type, seen without the type. `Base` is Vertex, Edge or Parameter.
template <typename Base>
class ElementPool {
 public:
  virtual ~ElementPool() = default;
  /// Number of slots, freed ones included; at() of a freed slot is a blank element.
  virtual std::int64_t slots() const = 0;
  virtual Base& at(std::int64_t slot) = 0;
  virtual const Base& at(std::int64_t slot) const = 0;
  /// A blank element in a free slot, or in a new one. Returns its slot.
  virtual std::int64_t add() = 0;
  /// Blanks the element and frees its slot.
  virtual void remove(std::int64_t slot) = 0;
  virtual void reserve(std::int64_t count) = 0;
  virtual std::unique_ptr<ElementPool> clone() const = 0;
};

/// Elements of type T in chunks: addresses never change, and a walk over a type is a walk over memory.
template <typename Base, typename T>
class TypedPool final : public ElementPool<Base> {
 public:
  static constexpr std::int64_t chunkSize = 256;

  TypedPool() = default;
  TypedPool(const TypedPool& other) : size_(other.size_), free_(other.free_) {
    chunks_.reserve(other.chunks_.size());
    for (const auto& chunk : other.chunks_) {
      chunks_.push_back(std::make_unique<T[]>(chunkSize));
      for (std::int64_t i = 0; i < chunkSize; ++i) chunks_.back()[i] = chunk[i];
    }
  }

  std::int64_t slots() const override { return size_; }
  Base& at(std::int64_t slot) override { return get(slot); }
  const Base& at(std::int64_t slot) const override { return get(slot); }
  T& get(std::int64_t slot) { return chunks_[static_cast<std::size_t>(slot / chunkSize)][slot % chunkSize]; }
  const T& get(std::int64_t slot) const {
    return chunks_[static_cast<std::size_t>(slot / chunkSize)][slot % chunkSize];
  }

  std::int64_t add() override {
    if (!free_.empty()) {
      const std::int64_t slot = free_.back();
      free_.pop_back();
      return slot;
    }
    if (size_ % chunkSize == 0 && size_ / chunkSize == static_cast<std::int64_t>(chunks_.size())) {
      chunks_.push_back(std::make_unique<T[]>(chunkSize));
    }
    return size_++;
  }

  void remove(std::int64_t slot) override {
    get(slot) = T();
    free_.push_back(slot);
  }

  void reserve(std::int64_t count) override { chunks_.reserve(static_cast<std::size_t>(count / chunkSize + 1)); }

  std::unique_ptr<ElementPool<Base>> clone() const override { return std::make_unique<TypedPool>(*this); }

 private:
  std::vector<std::unique_ptr<T[]>> chunks_;
  std::int64_t size_ = 0;
  std::vector<std::int64_t> free_;
};

}  // namespace quiver
