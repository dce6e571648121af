#include <algorithm>
#include <array>
#include <new>

#include <bzlib.h>
#include <fmt/format.h>
#include <zlib.h>

#include <quiver/core/io/files/deflate.h>
#include <quiver/core/util/error.h>

namespace quiver::detail {
namespace {

constexpr std::size_t pieceSize = std::size_t{1} << 28;  // both libraries count input in 32 bits

class GzipCompressor final : public Compressor {
 public:
  GzipCompressor() {
    if (deflateInit2(&stream_, Z_DEFAULT_COMPRESSION, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK) {
      throw std::bad_alloc();
    }
  }
  ~GzipCompressor() override { deflateEnd(&stream_); }
  GzipCompressor(const GzipCompressor&) = delete;
  GzipCompressor& operator=(const GzipCompressor&) = delete;

  void compress(std::string_view bytes, bool last, std::string& out) override {
    do {
      const std::string_view piece = bytes.substr(0, pieceSize);
      bytes.remove_prefix(piece.size());
      stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(piece.data()));
      stream_.avail_in = static_cast<uInt>(piece.size());
      drain(last && bytes.empty() ? Z_FINISH : Z_NO_FLUSH, out);
    } while (!bytes.empty());
  }

 private:
  void drain(int flush, std::string& out) {
    do {
      stream_.next_out = reinterpret_cast<Bytef*>(buffer_.data());
      stream_.avail_out = static_cast<uInt>(buffer_.size());
      const int code = deflate(&stream_, flush);
      if (code == Z_STREAM_ERROR) throw LogicError(fmt::format("deflate({}) refuses its stream", flush));
      out.append(buffer_.data(), buffer_.size() - stream_.avail_out);
    } while (stream_.avail_out == 0);
  }

  z_stream stream_{};
  std::array<char, 1 << 16> buffer_;
};

class Bzip2Compressor final : public Compressor {
 public:
  Bzip2Compressor() {
    if (BZ2_bzCompressInit(&stream_, 9, 0, 0) != BZ_OK) throw std::bad_alloc();
  }
  ~Bzip2Compressor() override { BZ2_bzCompressEnd(&stream_); }
  Bzip2Compressor(const Bzip2Compressor&) = delete;
  Bzip2Compressor& operator=(const Bzip2Compressor&) = delete;

  void compress(std::string_view bytes, bool last, std::string& out) override {
    while (!bytes.empty()) {
      const std::string_view piece = bytes.substr(0, pieceSize);
      bytes.remove_prefix(piece.size());
      stream_.next_in = const_cast<char*>(piece.data());
      stream_.avail_in = static_cast<unsigned>(piece.size());
      while (stream_.avail_in > 0) step(BZ_RUN, out);
    }
    while (last && step(BZ_FINISH, out) != BZ_STREAM_END) {
    }
  }

 private:
  int step(int action, std::string& out) {
    stream_.next_out = buffer_.data();
    stream_.avail_out = static_cast<unsigned>(buffer_.size());
    const int code = BZ2_bzCompress(&stream_, action);
    if (code < 0) throw LogicError(fmt::format("BZ2_bzCompress({}) returns {}", action, code));
    out.append(buffer_.data(), buffer_.size() - stream_.avail_out);
    return code;
  }

  bz_stream stream_{};
  std::array<char, 1 << 16> buffer_;
};

}  // namespace

std::unique_ptr<Compressor> makeCompressor(std::string_view path) {
  if (path.ends_with(".gz")) return std::make_unique<GzipCompressor>();
  if (path.ends_with(".bz2")) return std::make_unique<Bzip2Compressor>();
  return nullptr;
}

}  // namespace quiver::detail
