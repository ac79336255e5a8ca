#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>

#include "common/arm_plane/datagram_port.h"
#include "common/arm_plane/shared_object.h"
#include "common/clock.h"

namespace limber {
namespace {

/// Without a message for this long even an end that polls sleeps: nobody sends.
constexpr std::int64_t kLongestSpin_ns = 2'000'000;

void let_the_other_thread_run() noexcept {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

/// Not FUTEX_PRIVATE: two processes.
int futex(const std::atomic<std::uint32_t>& word, int operation, std::uint32_t value,
          const timespec* deadline) noexcept {
  return static_cast<int>(
      syscall(SYS_futex, &word, operation, value, deadline, nullptr, FUTEX_BITSET_MATCH_ANY));
}

class SharedMemoryPort final : public DatagramPort {
 public:
  SharedMemoryPort(const SharedMemoryAddress& address, ArmPlaneEnd end)
      : polls_(address.poll),
        object_(address, end),
        outgoing_(&object_->rings[static_cast<std::size_t>(end)]),
        incoming_(&object_->rings[1 - static_cast<std::size_t>(end)]),
        writer_(outgoing_),
        reader_(incoming_) {}

  bool send(std::span<const std::uint8_t> datagram) noexcept override {
    if (!writer_.write(datagram)) return false;
    if (writer_.reader_sleeps()) futex(outgoing_->newest, FUTEX_WAKE_BITSET, INT_MAX, nullptr);
    return true;
  }
  int receive(std::span<std::uint8_t> room) noexcept override { return reader_.read(room); }

  bool wait(std::int64_t deadline_ns) noexcept override {
    return reader_.something_waits() || (polls_ && spin(deadline_ns)) || sleep(deadline_ns);
  }
  std::int64_t dropped() const noexcept override { return reader_.dropped(); }

 private:
  bool spin(std::int64_t deadline_ns) const noexcept {
    const std::int64_t end_ns = std::min(deadline_ns, monotonic_ns() + kLongestSpin_ns);
    while (!reader_.something_waits()) {
      if (monotonic_ns() >= end_ns) return false;
      let_the_other_thread_run();
    }
    return true;
  }

  bool sleep(std::int64_t deadline_ns) noexcept {
    const timespec deadline{deadline_ns / 1'000'000'000, deadline_ns % 1'000'000'000};
    // Said before the last look at `newest`, which the kernel takes: either it sees the new number,
    // or the writer sees this.
    incoming_->sleeping.store(1, std::memory_order_seq_cst);
    bool interrupted = false;
    while (!reader_.something_waits() && !interrupted && monotonic_ns() < deadline_ns) {
      interrupted = futex(incoming_->newest, FUTEX_WAIT_BITSET, reader_.last(), &deadline) != 0 &&
                    errno == EINTR;
    }
    incoming_->sleeping.store(0, std::memory_order_relaxed);
    return reader_.something_waits();
  }

  bool polls_;
  SharedObject object_;
  SharedRing* outgoing_;
  SharedRing* incoming_;
  RingWriter writer_;
  RingReader reader_;
};

}  // namespace

std::unique_ptr<DatagramPort> open_shared_memory_port(const std::string& url, ArmPlaneEnd end) {
  return std::make_unique<SharedMemoryPort>(parse_shared_memory_address(url), end);
}

}  // namespace limber
