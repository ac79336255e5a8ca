#include "common/realtime.h"

#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>

#include <cerrno>
#include <cstring>

#include "common/clock.h"

namespace limber {

RealtimeGrant ask_for_realtime(int priority) {
  RealtimeGrant grant;
  prctl(PR_SET_TIMERSLACK, 1UL);  // the default 50 us would be the largest part of the jitter
  sched_param parameter{};
  parameter.sched_priority = priority;
  grant.fifo = sched_setscheduler(0, SCHED_FIFO, &parameter) == 0;
  if (!grant.fifo) grant.reason = std::string("SCHED_FIFO refused: ") + std::strerror(errno);
  grant.locked_memory = mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  if (!grant.locked_memory) {
    if (!grant.reason.empty()) grant.reason += "; ";
    grant.reason += std::string("locked memory refused: ") + std::strerror(errno);
  }
  return grant;
}

void PeriodicLoop::start() noexcept { deadline_ns_ = monotonic_ns() + period_ns_; }

std::int64_t PeriodicLoop::wait() noexcept {
  const std::int64_t target = deadline_ns_;
  std::int64_t now = monotonic_ns();
  if (target - spin_ns_ > now) {
    const std::int64_t wake = target - spin_ns_;
    const timespec until{wake / 1'000'000'000, wake % 1'000'000'000};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
    }
  }
  while ((now = monotonic_ns()) < target) {
  }
  deadline_ns_ += period_ns_;
  if (deadline_ns_ <= now) {
    const std::int64_t missed = (now - deadline_ns_) / period_ns_ + 1;
    deadline_ns_ += missed * period_ns_;
  }
  return now - target;
}

}  // namespace limber
