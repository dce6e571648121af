#pragma once

#include <cstdio>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace quiver::app {

/// To be called before anything is opened: a standard stream that the caller closed is made one that refuses to be read
/// or written. Otherwise the next file opened would take its number, and what is said would be written into it.
void holdStandardStreams();

/// Writes text to a stream, whatever becomes of it: what cannot be said is no reason to give up work.
void write(std::FILE* stream, const std::string& text);

/// Formats and writes.
template <typename... Arguments>
void tell(std::FILE* stream, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  write(stream, fmt::format(format, std::forward<Arguments>(arguments)...));
}

/// Brings out what standard output still holds; why it failed, now or earlier, or nothing.
std::string standardOutputFailure();

}  // namespace quiver::app
