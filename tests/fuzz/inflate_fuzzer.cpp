// Any bytes inflated as what they claim to be: either it works or it throws a file's error; nothing leaks or overflows.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include <quiver/core/io/files/inflate.h>
#include <quiver/core/util/error.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace quiver;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const detail::Compression compression = detail::detectCompression(bytes);
  if (compression == detail::Compression::none) return 0;
  try {
    constexpr std::size_t limit = 1 << 20;
    detail::ByteBuffer out;
    detail::inflateAll(compression, bytes, "input", limit, out);
  } catch (const Error&) {
  }
  return 0;
}
