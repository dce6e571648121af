#include <quiver/core/io/bal/bal_format.h>

#include <cstddef>
#include <string>

#include <fmt/format.h>

#include <quiver/core/io/text/number_parser.h>
#include <quiver/core/util/error.h>

namespace quiver::detail {
namespace {

template <typename Type>
const Type& required(const Type* type, const char* tag) {
  if (type) return *type;
  throw GraphError(fmt::format("bundle adjustment files need the type {}, which the registry does not have", tag));
}

}  // namespace

BalTypes::BalTypes(const Registry& registry)
    : camera(&required(registry.findVertexType("VERTEX_CAMERA:BAL"), "VERTEX_CAMERA:BAL")),
      point(&required(registry.findVertexType("VERTEX_TRACKXYZ"), "VERTEX_TRACKXYZ")),
      observation(&required(registry.findEdgeType("EDGE_PROJECT_BAL"), "EDGE_PROJECT_BAL")) {}

bool looksLikeBal(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return false;
  text.remove_prefix(first);
  const ParsedNumber<double> number = parseReal(text.data(), text.data() + text.size());
  if (number.status != NumberStatus::ok) return false;
  return number.end == text.data() + text.size() ||
         std::string_view(" \t\r\n").find(*number.end) != std::string_view::npos;
}

}  // namespace quiver::detail
