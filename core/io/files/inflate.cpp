#include <algorithm>
#include <limits>

#include <bzlib.h>
#include <fmt/format.h>
#include <zlib.h>

#include <quiver/core/io/files/inflate.h>
#include <quiver/core/util/error.h>

namespace quiver::detail {
namespace {

constexpr std::size_t chunk = std::size_t{1} << 18;

enum class Progress { more, memberEnd, corrupt };

/// One inflater's state behind one face: restart() begins a member, step() consumes input and fills [out, out + room).
class GzipInflater {
 public:
  static constexpr const char* format = "gzip";
  GzipInflater() {
    if (inflateInit2(&stream_, 15 + 16) != Z_OK) throw std::bad_alloc();
  }
  ~GzipInflater() { inflateEnd(&stream_); }
  GzipInflater(const GzipInflater&) = delete;
  GzipInflater& operator=(const GzipInflater&) = delete;

  void restart() { inflateReset(&stream_); }

  Progress step(std::string_view& in, char* out, std::size_t room, std::size_t& written) {
    const auto available = static_cast<uInt>(std::min<std::size_t>(in.size(), std::numeric_limits<uInt>::max()));
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(in.data()));
    stream_.avail_in = available;
    stream_.next_out = reinterpret_cast<Bytef*>(out);
    stream_.avail_out = static_cast<uInt>(room);
    const int code = inflate(&stream_, Z_NO_FLUSH);
    in.remove_prefix(available - stream_.avail_in);
    written = room - stream_.avail_out;
    if (code == Z_STREAM_END) return Progress::memberEnd;
    if (code == Z_MEM_ERROR) throw std::bad_alloc();
    return code == Z_OK || code == Z_BUF_ERROR ? Progress::more : Progress::corrupt;
  }

 private:
  z_stream stream_{};
};

class Bzip2Inflater {
 public:
  static constexpr const char* format = "bzip2";
  Bzip2Inflater() { open(); }
  ~Bzip2Inflater() { BZ2_bzDecompressEnd(&stream_); }
  Bzip2Inflater(const Bzip2Inflater&) = delete;
  Bzip2Inflater& operator=(const Bzip2Inflater&) = delete;

  void restart() {
    BZ2_bzDecompressEnd(&stream_);
    open();
  }

  Progress step(std::string_view& in, char* out, std::size_t room, std::size_t& written) {
    const auto available =
        static_cast<unsigned>(std::min<std::size_t>(in.size(), std::numeric_limits<unsigned>::max()));
    stream_.next_in = const_cast<char*>(in.data());
    stream_.avail_in = available;
    stream_.next_out = out;
    stream_.avail_out = static_cast<unsigned>(room);
    const int code = BZ2_bzDecompress(&stream_);
    in.remove_prefix(available - stream_.avail_in);
    written = room - stream_.avail_out;
    if (code == BZ_STREAM_END) return Progress::memberEnd;
    if (code == BZ_MEM_ERROR) throw std::bad_alloc();
    return code == BZ_OK ? Progress::more : Progress::corrupt;
  }

 private:
  void open() {
    stream_ = {};
    if (BZ2_bzDecompressInit(&stream_, 0, 0) != BZ_OK) throw std::bad_alloc();
  }

  bz_stream stream_{};
};

bool isPadding(std::string_view bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](char c) { return c == '\0'; });
}

template <typename Inflater>
void inflateMembers(std::string_view in, const std::string& name, std::size_t maxBytes, ByteBuffer& out) {
  const Compression compression = detectCompression(in);
  const auto refuse = [&](const char* what) {
    throw ParseError(name, 0, 0, fmt::format("{} data {}", Inflater::format, what));
  };
  Inflater inflater;
  for (;;) {
    out.makeRoom(chunk);
    const std::size_t room = std::min(out.capacity() - out.size(), std::size_t{1} << 30);
    const std::size_t before = in.size();
    std::size_t written = 0;
    const Progress progress = inflater.step(in, out.data() + out.size(), room, written);
    out.append(written);
    if (out.size() > maxBytes) {
      throw FileError(fmt::format("{}: inflates to more than {} bytes", name, maxBytes));
    }
    if (progress == Progress::corrupt) refuse("is corrupt");
    if (progress == Progress::more) {
      if (written == 0 && in.size() == before) refuse("is truncated");
      continue;
    }
    if (isPadding(in)) return;
    if (detectCompression(in) != compression) refuse("is followed by something else");
    inflater.restart();
  }
}

}  // namespace

Compression detectCompression(std::string_view bytes) {
  if (bytes.starts_with("\x1f\x8b")) return Compression::gzip;
  if (bytes.size() >= 4 && bytes.starts_with("BZh") && bytes[3] >= '1' && bytes[3] <= '9') {
    // A block's or the stream's end magic follows; without it this is a text that begins with these letters, unless it
    // is cut off.
    const std::string_view magic = bytes.substr(4, 6);
    const std::string_view block = "\x31\x41\x59\x26\x53\x59";
    const std::string_view streamEnd = "\x17\x72\x45\x38\x50\x90";
    if (block.starts_with(magic) || streamEnd.starts_with(magic)) return Compression::bzip2;
  }
  return Compression::none;
}

void inflateAll(Compression compression, std::string_view bytes, const std::string& name, std::size_t maxBytes,
                ByteBuffer& out) {
  if (compression == Compression::gzip) inflateMembers<GzipInflater>(bytes, name, maxBytes, out);
  if (compression == Compression::bzip2) inflateMembers<Bzip2Inflater>(bytes, name, maxBytes, out);
}

}  // namespace quiver::detail
