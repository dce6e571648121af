#pragma once

#include <string_view>

/// The name of T within a text that is the same for every type. Of no namespace, since g++ leaves out of T's name the
/// namespaces that it shares with the function.
template <typename T>
constexpr std::string_view quiverTypeSignature() {
  return __PRETTY_FUNCTION__;
}

namespace quiver {

/// The qualified name of a C++ type, as the compiler spells it: the identity by which a registry finds a type's
/// descriptor. Unlike `typeid` and addresses of static objects it is the same in every library of a process. Types of
/// one name in anonymous namespaces of two files cannot be told apart by it.
template <typename T>
constexpr std::string_view typeName() {
  constexpr std::string_view known = "double", sample = quiverTypeSignature<double>();
  constexpr std::size_t before = sample.find(known);
  constexpr std::size_t after = sample.size() - before - known.size();
  constexpr std::string_view signature = quiverTypeSignature<T>();
  return signature.substr(before, signature.size() - before - after);
}

}  // namespace quiver
