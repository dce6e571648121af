#include <quiver/apps/support/interrupt.h>

#include <csignal>
#include <cstring>

#include <fmt/format.h>
#include <unistd.h>

#include <quiver/core/util/error.h>
#include <quiver/core/util/signals_blocked.h>

namespace quiver::app {
namespace {

// A signal handler can reach nothing but globals.
volatile std::sig_atomic_t signalPipe = -1;
volatile std::sig_atomic_t signalsSeen = 0;

// Requesting a stop is not allowed inside a handler, writing a byte is; the watcher does the rest.
void onSignal(int signal) {
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
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  struct sigaction before;
  sigaction(SIGHUP, nullptr, &before);
  if (before.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);  // nohup asks to go on
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

}  // namespace quiver::app
