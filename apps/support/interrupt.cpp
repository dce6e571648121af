#include <quiver/apps/support/interrupt.h>

#include <csignal>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>
#include <unistd.h>

#include <quiver/core/util/error.h>
#include <quiver/core/util/signals_blocked.h>

namespace quiver::app {
namespace {

// A signal handler can reach nothing but globals.
volatile std::sig_atomic_t signalPipe = -1;
volatile std::sig_atomic_t signalsSeen = 0;
volatile std::sig_atomic_t saving = 0;

// Requesting a stop is not allowed inside a handler, writing a byte is; the watcher does the rest.
void onSignal(int signal) {
  if (signalsSeen && saving) return;
  if (signalsSeen) _exit(128 + signal);
  signalsSeen = 1;
  const char byte = 1;
  if (write(signalPipe, &byte, 1) != 1) _exit(128 + signal);
}

void setHandler(void (*handler)(int)) {
  struct sigaction action;
  std::memset(&action, 0, sizeof action);
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before;
    sigaction(signal, nullptr, &before);
    const bool ignored = signal == SIGHUP && before.sa_handler == SIG_IGN;  // nohup asks to go on
    if (!ignored) sigaction(signal, &action, nullptr);
  }
}

}  // namespace

Interrupt::Interrupt() {
  if (pipe(pipe_) != 0) throw Error(fmt::format("no pipe for signals: {}", std::strerror(errno)));
  {
    const SignalsBlocked blocked;
    watcher_ = std::thread([this] {
      char byte = 0;
      if (read(pipe_[0], &byte, 1) == 1) source_.request_stop();
    });
  }
  signalsSeen = 0;
  signalPipe = pipe_[1];
  setHandler(onSignal);
}

Interrupt::~Interrupt() {
  setHandler(SIG_DFL);
  close(pipe_[1]);  // ends the watcher's read
  watcher_.join();
  close(pipe_[0]);
}

Interrupt::Saving::Saving(const std::string& path) {
  std::error_code error;
  const std::filesystem::file_type type = std::filesystem::status(path, error).type();
  // What is written directly may wait for its reader for ever.
  const bool replaced = type == std::filesystem::file_type::regular || type == std::filesystem::file_type::not_found;
  saving = path != "-" && replaced ? 1 : 0;
}

Interrupt::Saving::~Saving() { saving = 0; }

}  // namespace quiver::app
