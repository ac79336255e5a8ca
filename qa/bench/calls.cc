// What cycles ask of heap and kernel: driver, controller, motor nodes and arm in one process, held
// by a Cartesian impedance. After a warm-up the heap's entry points count, getrusage() tells page
// faults, and a seccomp filter turns each system call into a signal: a lock that waits, or wakes
// somebody, is a futex call and counts, any other call ends the program. Prints one JSON line. All
// of it has to be zero.
//
//   limber-bench-calls [--cycles 1000000]
#include <fmt/format.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

#include "common/program.h"
#include "qa/bench/held_arm.h"
#include "tools/allocations/allocations.h"

using namespace limber;

namespace {

constexpr int kWarmUp = 5000;  // cycles

std::atomic<std::int64_t> futex_calls = 0;

/// The kernel leaves the call undone. A futex that fails is tried again or was a wake-up of nobody;
/// of the others there are none, or this is the end.
void count_call(int /*signal*/, siginfo_t* info, void* /*context*/) {
  if (info->si_syscall == __NR_futex) {
    ++futex_calls;
    return;
  }
  constexpr std::string_view kProblem = "limber-bench-calls: a cycle made a system call\n";
  static_cast<void>(!write(STDERR_FILENO, kProblem.data(), kProblem.size()));
  _exit(kExitFailed);
}

/// From here on each system call of this thread, but for those that end this program, becomes a
/// signal.
void trap_system_calls() {
  struct sigaction action {};
  action.sa_sigaction = count_call;
  action.sa_flags = SA_SIGINFO;
  sigaction(SIGSYS, &action, nullptr);
  constexpr std::array kMade = {__NR_rt_sigreturn, __NR_getrusage, __NR_write, __NR_exit_group};
  std::array<sock_filter, kMade.size() + 3> program{};
  program[0] = BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr));
  for (std::size_t i = 0; i < kMade.size(); ++i) {
    const auto to_made = static_cast<std::uint8_t>(kMade.size() - i);
    program[i + 1] =
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<unsigned>(kMade[i]), to_made, 0);
  }
  program[kMade.size() + 1] = BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP);
  program[kMade.size() + 2] = BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
  const sock_fprog filter{program.size(), program.data()};
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
      prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) != 0)
    throw std::runtime_error("this kernel permits no seccomp filter");
}

std::int64_t page_faults() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_minflt + usage.ru_majflt;
}

int run(std::int64_t cycles) {
  bench::HeldArm arm("openarm", Integrator::kReference);
  mlockall(MCL_CURRENT | MCL_FUTURE);  // as the processes do; where it is refused they run on
  arm.run(kWarmUp);
  trap_system_calls();
  const std::int64_t heap_before = allocations();
  const std::int64_t faults_before = page_faults();
  arm.run(cycles);
  const std::int64_t faults = page_faults() - faults_before;
  const std::int64_t heap = allocations() - heap_before;
  arm.require_held();
  const std::string line = fmt::format(
      "{{\"cycles\": {}, \"heap_requests\": {}, \"page_faults\": {}, \"futex_calls\": {}}}\n",
      cycles, heap, faults, futex_calls.load());
  static_cast<void>(!write(STDOUT_FILENO, line.data(), line.size()));
  _exit(kExitDone);  // the end of a process makes system calls of its own
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine line("limber-bench-calls", "What control cycles ask of heap and kernel.");
  std::int64_t cycles = 1'000'000;
  line.integer("--cycles", &cycles, 1, 1'000'000'000, "cycles that are watched");
  return run_program(line, argc, argv, [&] { return run(cycles); });
}
