#pragma once

#include <string_view>

namespace quiver {

/// The qualified name of a C++ type, as the compiler spells it: the identity by which a registry finds a type's
/// descriptor. Unlike `typeid` and addresses of static objects it is the same in every library of a process.
template <typename T>
constexpr std::string_view typeName() {
  constexpr std::string_view signature = __PRETTY_FUNCTION__;
  constexpr std::string_view marker = "T = ";
  constexpr std::size_t begin = signature.find(marker) + marker.size();
  constexpr std::size_t end = signature.find_first_of(";]", begin);
  return signature.substr(begin, end - begin);
}

}  // namespace quiver
