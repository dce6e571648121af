#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace quiver {

/// The ids an edge holds, those of its vertices and then those of its parameters: up to four in place, more on the
/// heap.
class EdgeIdList {
 public:
  static constexpr std::size_t inPlace = 4;

  EdgeIdList() = default;
  EdgeIdList(std::span<const std::int64_t> vertices, std::span<const std::int64_t> parameters) {
    assign(vertices, parameters);
  }
  EdgeIdList(const EdgeIdList& other) : EdgeIdList(other.vertices(), other.parameters()) {}
  EdgeIdList(EdgeIdList&& other) noexcept { swap(other); }
  EdgeIdList& operator=(const EdgeIdList& other) {
    EdgeIdList copy(other);
    swap(copy);
    return *this;
  }
  EdgeIdList& operator=(EdgeIdList&& other) noexcept {
    swap(other);
    return *this;
  }
  ~EdgeIdList() {
    if (onHeap()) delete[] words_.heap;
  }

  /// Replaces what is here; neither span may be of this list.
  void assign(std::span<const std::int64_t> vertices, std::span<const std::int64_t> parameters) {
    const std::size_t count = vertices.size() + parameters.size();
    std::int64_t* const heap = count > inPlace ? new std::int64_t[count] : nullptr;
    if (onHeap()) delete[] words_.heap;
    if (heap != nullptr) words_.heap = heap;
    vertices_ = static_cast<std::uint32_t>(vertices.size());
    parameters_ = static_cast<std::uint32_t>(parameters.size());
    // Loops over so few words cost less than calls that move memory.
    std::int64_t* out = data();
    for (const std::int64_t id : vertices) *out++ = id;
    for (const std::int64_t id : parameters) *out++ = id;
  }

  std::span<const std::int64_t> vertices() const { return {data(), vertices_}; }
  std::span<const std::int64_t> parameters() const { return {data() + vertices_, parameters_}; }
  int vertexCount() const { return static_cast<int>(vertices_); }
  std::int64_t vertex(int role) const { return data()[role]; }

 private:
  /// Which of them it is, the counts tell.
  union Words {
    std::array<std::int64_t, inPlace> place{};
    std::int64_t* heap;
  };

  bool onHeap() const { return std::size_t{vertices_} + parameters_ > inPlace; }
  std::int64_t* data() { return onHeap() ? words_.heap : words_.place.data(); }
  const std::int64_t* data() const { return onHeap() ? words_.heap : words_.place.data(); }
  void swap(EdgeIdList& other) noexcept {
    std::swap(words_, other.words_);
    std::swap(vertices_, other.vertices_);
    std::swap(parameters_, other.parameters_);
  }

  Words words_;
  std::uint32_t vertices_ = 0;
  std::uint32_t parameters_ = 0;
};

}  // namespace quiver
