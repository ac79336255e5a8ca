// A child process that ends with its parent.
#pragma once

#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <stdexcept>

namespace limber {

/// Runs `body` in a child, which dies with this process and does not return. Set-up only.
template <typename Body>
pid_t spawn(Body body) {
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    body();
    _exit(3);
  }
  return child;
}

}  // namespace limber
