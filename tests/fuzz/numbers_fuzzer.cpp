// Any text scanned as numbers: never past the end, and every number read is the one strtod reads.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include <quiver/core/io/text/text_scanner.h>

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

void scan(std::string_view text) {
  quiver::TextScanner scanner(text);
  while (!scanner.atEnd()) {
    while (!scanner.atLineEnd()) {
      const char* const before = scanner.cursor();
      double real = 0;
      if (scanner.real(real) == quiver::NumberStatus::ok) {
        const std::string token(before, scanner.cursor());
        require(std::isfinite(real) && real == std::strtod(token.c_str(), nullptr));
      } else {
        require(!scanner.token().empty());
      }
      require(scanner.cursor() > before);
    }
    scanner.nextLine();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // A copy of exactly this size, so that the sanitizer sees the first byte read too far.
  const std::string copy(reinterpret_cast<const char*>(data), size);
  scan(copy);
  return 0;
}
