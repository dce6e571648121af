#pragma once

#include <stop_token>
#include <string>
#include <thread>

namespace quiver::app {

/// While it lives, the first SIGINT, SIGTERM or SIGHUP (unless ignored, as under nohup) requests a stop, and the second
/// ends the process at once. One at a time.
class Interrupt {
 public:
  /// While it lives, the second signal is ignored too: the file that is being written would be left unfinished beside
  /// its place. Not where the path is no regular file's. One at a time.
  class Saving {
   public:
    explicit Saving(const std::string& path);
    ~Saving();
    Saving(const Saving&) = delete;
    Saving& operator=(const Saving&) = delete;
  };

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
