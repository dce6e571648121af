#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace quiver::detail {

/// Compresses a stream piece by piece. The output depends on the bytes alone: no time stamp, no file name.
class Compressor {
 public:
  virtual ~Compressor() = default;
  /// Takes `bytes` and appends what is ready to `out`; with `last` everything that was held back, and the end of the
  /// format.
  virtual void compress(std::string_view bytes, bool last, std::string& out) = 0;
};

/// gzip for "….gz", bzip2 for "….bz2", nullptr for any other name.
std::unique_ptr<Compressor> makeCompressor(std::string_view path);

}  // namespace quiver::detail
