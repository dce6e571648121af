#include "separate_process.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <exception>

namespace quiver::bench {

SeparateResult inSeparateProcess(const std::function<std::string()>& work) {
  std::array<int, 2> ends;
  SeparateResult result;
  if (pipe(ends.data()) != 0) return result;
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    int status = 0;
    try {
      const std::string text = work();
      for (std::size_t sent = 0; sent < text.size();) {
        const ssize_t count = write(ends[1], text.data() + sent, text.size() - sent);
        if (count <= 0) break;
        sent += static_cast<std::size_t>(count);
      }
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s\n", error.what());
      status = 1;
    }
    std::fflush(nullptr);
    _exit(status);
  }
  close(ends[1]);
  std::array<char, 4096> buffer;
  for (ssize_t count = 0; (count = read(ends[0], buffer.data(), buffer.size())) > 0;)
    result.text.append(buffer.data(), static_cast<std::size_t>(count));
  close(ends[0]);
  int status = 1;
  rusage usage{};
  if (child > 0 && wait4(child, &status, 0, &usage) == child) result.ok = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  result.peakMegabytes = static_cast<double>(usage.ru_maxrss) / 1024.0;
  return result;
}

}  // namespace quiver::bench
