#pragma once

#include <stop_token>
#include <thread>

namespace quiver::app {

/// While it lives, the first SIGINT, SIGTERM or SIGHUP (unless ignored, as under nohup) requests a stop, and the second
/// ends the process at once. One at a time.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  std::stop_token token() const { return source_.get_token(); }

 private:
  std::stop_source source_;
  int pipe_[2] = {-1, -1};
  std::thread watcher_;
};

}  // namespace quiver::app
