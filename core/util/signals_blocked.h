#pragma once

#include <csignal>
#include <initializer_list>

namespace quiver {

/// While it lives the calling thread takes no signals from outside, nor do threads that it starts meanwhile, ever: they
/// go to the threads of the program, where whoever handles them expects them. Faults and profilers are let through.
class SignalsBlocked {
 public:
#if defined(__unix__)
  SignalsBlocked() {
    sigset_t all;
    sigfillset(&all);
    for (const int own : {SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGPROF, SIGSEGV, SIGTRAP}) sigdelset(&all, own);
    pthread_sigmask(SIG_BLOCK, &all, &before_);
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
