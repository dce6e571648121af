#pragma once

#include <csignal>

namespace quiver {

/// While it lives the calling thread takes no signals, nor do threads that it starts meanwhile, ever: they go to the
/// threads of the program, where whoever handles them expects them.
class SignalsBlocked {
 public:
#if defined(__unix__)
  SignalsBlocked() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~SignalsBlocked() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
#else
  SignalsBlocked() {}
#endif
  SignalsBlocked(const SignalsBlocked&) = delete;
  SignalsBlocked& operator=(const SignalsBlocked&) = delete;

#if defined(__unix__)
 private:
  sigset_t before_;
#endif
};

}  // namespace quiver
