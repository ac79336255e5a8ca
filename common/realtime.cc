#include "common/realtime.h"

#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>

#include <cerrno>
#include <cstring>

#include "common/clock.h"

namespace limber {
namespace {

/// Under a limit (ulimit -l) that is enough for what a process has at its start, whatever it
/// requests later would be refused, instead of not being locked: it would end with bad_alloc.
bool room_for_more() {
  constexpr std::size_t kRoom_bytes = 256 << 20;  // nobody may use it, so that it costs nothing
  void* room = mmap(nullptr, kRoom_bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  return room != MAP_FAILED && munmap(room, kRoom_bytes) == 0;
}

bool lock_memory() {
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) return false;
  if (room_for_more()) return true;
  munlockall();
  return false;
}

std::string lock_refusal() {
  rlimit limit{};
  getrlimit(RLIMIT_MEMLOCK, &limit);
  return "locked memory refused: only " + std::to_string(limit.rlim_cur / 1024) +
         " KiB are permitted (ulimit -l)";
}

}  // namespace

RealtimeGrant ask_for_realtime(int priority) {
  RealtimeGrant grant;
  prctl(PR_SET_TIMERSLACK, 1UL);  // the default 50 us would be the largest part of the jitter
  sched_param parameter{};
  parameter.sched_priority = priority;
  grant.fifo = sched_setscheduler(0, SCHED_FIFO, &parameter) == 0;
  if (!grant.fifo) grant.reason = std::string("SCHED_FIFO refused: ") + std::strerror(errno);
  grant.locked_memory = lock_memory();
  if (!grant.locked_memory) {
    if (!grant.reason.empty()) grant.reason += "; ";
    grant.reason += lock_refusal();
  }
  return grant;
}

std::string raise_priority(bool paced) {
  constexpr int kNice = -15;
  prctl(PR_SET_TIMERSLACK, 1UL);
  sched_param lowest{};
  lowest.sched_priority = sched_get_priority_min(SCHED_RR);
  if (paced && sched_setscheduler(0, SCHED_RR, &lowest) == 0) return "";
  if (setpriority(PRIO_PROCESS, 0, kNice) == 0) return "";
  return std::string("a raised priority is refused: ") + std::strerror(errno);
}

void sleep_until(std::int64_t time_ns) noexcept {
  const timespec until{time_ns / 1'000'000'000, time_ns % 1'000'000'000};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

void PeriodicLoop::start() noexcept { deadline_ns_ = monotonic_ns() + period_ns_; }

std::int64_t PeriodicLoop::wait() noexcept {
  const std::int64_t target = deadline_ns_;
  std::int64_t now = monotonic_ns();
  if (target - spin_ns_ > now) sleep_until(target - spin_ns_);
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
