#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

namespace quiver {

/// All elements of one type, seen without the type. `Base` is Vertex, Edge or Parameter.
///
/// Elements lie in chunks: addresses never change, and a walk over a type is a walk over memory.
template <typename Base>
class ElementPool {
 public:
  static constexpr std::int64_t chunkSize = 256;

  virtual ~ElementPool() = default;
  /// Number of slots, freed ones included; at() of a freed slot is a blank element.
  std::int64_t slots() const { return size_; }
  Base& at(std::int64_t slot) { return *place(chunks_[static_cast<std::size_t>(slot / chunkSize)], slot % chunkSize); }
  const Base& at(std::int64_t slot) const { return const_cast<ElementPool*>(this)->at(slot); }
  /// Calls visit(element) for every slot, in order.
  template <typename Visit>
  void forEach(Visit&& visit) {
    const auto chunks = static_cast<std::int64_t>(chunks_.size());
    for (std::int64_t chunk = 0; chunk < chunks && chunk * chunkSize < size_; ++chunk) {
      const std::int64_t count = std::min(chunkSize, size_ - chunk * chunkSize);
      std::byte* const first = chunks_[static_cast<std::size_t>(chunk)];
      for (std::int64_t i = 0; i < count; ++i) visit(*place(first, i));
    }
  }
  struct Added {
    Base& element;
    std::int64_t slot;
  };
  /// A blank element in a free slot, or in a new one.
  virtual Added add() = 0;
  /// Blanks what the element says and frees its slot.
  virtual void remove(std::int64_t slot) = 0;
  /// Room, in one piece, for the slots below `count`.
  virtual void reserve(std::int64_t count) = 0;
  virtual std::unique_ptr<ElementPool> clone() const = 0;

  /// Appends slots whose elements construct() is to make, each once. Until then the pool may be added to, but neither
  /// copied nor destroyed. Returns the first slot. (Elements whose constructor may throw are made at once.)
  virtual std::int64_t append(std::int64_t count) = 0;
  /// Makes blank elements in appended slots. Thread safe for slots that differ.
  virtual void construct(std::int64_t first, std::int64_t count) noexcept = 0;

 protected:
  explicit ElementPool(std::size_t elementSize) : elementSize_(elementSize) {}

  Base* place(std::byte* chunk, std::int64_t element) const {
    return reinterpret_cast<Base*>(chunk + static_cast<std::size_t>(element) * elementSize_);
  }

  /// Where the Base of each chunk's first element is or will be.
  std::vector<std::byte*> chunks_;
  std::int64_t size_ = 0;

 private:
  std::size_t elementSize_;
};

/// Elements of type T. Memory is touched when an element is made there, not before.
template <typename Base, typename T>
class TypedPool final : public ElementPool<Base> {
  using ElementPool<Base>::chunkSize;
  using ElementPool<Base>::chunks_;
  using ElementPool<Base>::size_;

 public:
  TypedPool() : ElementPool<Base>(sizeof(T)) {}
  TypedPool(const TypedPool& other) : TypedPool() {
    makeRoom(other.size_);
    for (; size_ < other.size_; ++size_) std::construct_at(&get(size_), other.get(size_));
    free_ = other.free_;
  }
  TypedPool& operator=(const TypedPool&) = delete;
  ~TypedPool() override {
    if constexpr (!std::is_trivially_destructible_v<T>) {
      for (std::int64_t slot = 0; slot < size_; ++slot) std::destroy_at(&get(slot));
    }
  }

  T& get(std::int64_t slot) {
    std::byte* const chunk = chunks_[static_cast<std::size_t>(slot / chunkSize)];
    return static_cast<T*>(reinterpret_cast<Base*>(chunk))[slot % chunkSize];
  }
  const T& get(std::int64_t slot) const { return const_cast<TypedPool*>(this)->get(slot); }

  typename ElementPool<Base>::Added add() override {
    if (!free_.empty()) {
      const std::int64_t slot = free_.back();
      free_.pop_back();
      return {get(slot), slot};
    }
    if (size_ == static_cast<std::int64_t>(chunks_.size()) * chunkSize) makeRoom(size_ + 1);
    T& element = make(size_);
    return {element, size_++};
  }

  void remove(std::int64_t slot) override {
    get(slot) = T();
    free_.push_back(slot);
  }

  void reserve(std::int64_t count) override { makeRoom(count); }

  std::unique_ptr<ElementPool<Base>> clone() const override { return std::make_unique<TypedPool>(*this); }

  std::int64_t append(std::int64_t count) override {
    makeRoom(size_ + count);
    const std::int64_t first = size_;
    if constexpr (madeLater) {
      size_ += count;
    } else {
      for (; size_ < first + count; ++size_) make(size_);
    }
    return first;
  }
  void construct(std::int64_t first, std::int64_t count) noexcept override {
    if constexpr (madeLater) {
      for (std::int64_t slot = first; slot < first + count; ++slot) make(slot);
    }
  }

 private:
  /// A blank element, members without an initialiser zero too. Zeroing first what is initialised anyway would cost as
  /// much as all the rest of adding an edge.
  T& make(std::int64_t slot) {
    if constexpr (requires { T::template addsNothing<T>(); }) {
      if constexpr (T::template addsNothing<T>()) return *::new (static_cast<void*>(&get(slot))) T;
    }
    return *std::construct_at(&get(slot));
  }

  static constexpr bool madeLater = std::is_nothrow_default_constructible_v<T>;

  /// Raw memory of whole chunks, one after the other.
  struct Block {
    explicit Block(std::int64_t elements)
        : count(static_cast<std::size_t>(elements)), data(std::allocator<T>().allocate(count)) {}
    Block(Block&& other) noexcept : count(other.count), data(std::exchange(other.data, nullptr)) {}
    Block& operator=(Block&&) = delete;
    ~Block() {
      if (data) std::allocator<T>().deallocate(data, count);
    }
    std::size_t count;
    T* data;
  };

  void makeRoom(std::int64_t count) {
    const std::int64_t missing = (count + chunkSize - 1) / chunkSize - static_cast<std::int64_t>(chunks_.size());
    if (missing <= 0) return;
    blocks_.emplace_back(missing * chunkSize);
    for (std::int64_t i = 0; i < missing; ++i) {
      Base* const first = blocks_.back().data + i * chunkSize;
      chunks_.push_back(reinterpret_cast<std::byte*>(first));
    }
  }

  std::vector<Block> blocks_;
  std::vector<std::int64_t> free_;
};

}  // namespace quiver
