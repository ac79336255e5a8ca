#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>

#include "common/arm_plane/datagram_port.h"
#include "common/arm_plane/shared_memory_address.h"
#include "common/clock.h"
#include "common/config_error.h"
#include "common/shared_memory/spin.h"

namespace limber {
namespace {

/// Not FUTEX_PRIVATE: two processes.
int futex(const std::atomic<std::uint32_t>& word, int operation, std::uint32_t value,
          const timespec* deadline) noexcept {
  return static_cast<int>(
      syscall(SYS_futex, &word, operation, value, deadline, nullptr, FUTEX_BITSET_MATCH_ANY));
}

const char* name_of(ArmPlaneEnd end) {
  return end == ArmPlaneEnd::kDriver ? "driver" : "controller";
}

class SharedMemoryPort final : public DatagramPort {
 public:
  SharedMemoryPort(const SharedMemoryAddress& address, ArmPlaneEnd end)
      : polls_(address.poll),
        own_(static_cast<std::size_t>(end)),
        object_(address.place, sizeof(SharedMemory)),
        memory_(*static_cast<SharedMemory*>(object_.memory())),
        writer_(&memory_.rings[own_]),
        reader_(&memory_.rings[other()]) {
    std::atomic<std::uint32_t>& holder = memory_.holders[own_];
    if (!object_.take(static_cast<int>(end))) {
      throw ConfigError(address.place.what + ": there is already a " + name_of(end) + " (process " +
                        std::to_string(holder.load()) +
                        "); stop it first, or give this one a name of its own");
    }
    holder.store(static_cast<std::uint32_t>(getpid()));
  }

  bool send(std::span<const std::uint8_t> datagram) noexcept override {
    if (!writer_.write(datagram)) return false;
    if (memory_.sleeping[other()].load(std::memory_order_seq_cst) != 0)
      futex(memory_.rings[own_].newest, FUTEX_WAKE_BITSET, INT_MAX, nullptr);
    return true;
  }
  int receive(std::span<std::uint8_t> room) noexcept override { return reader_.read(room); }

  bool wait(std::int64_t deadline_ns) noexcept override {
    const auto arrived = [this] { return reader_.something_waits(); };
    return (polls_ && spin_until(deadline_ns, arrived)) || arrived() || sleep(deadline_ns);
  }
  std::int64_t dropped() const noexcept override { return reader_.dropped(); }

 private:
  std::size_t other() const noexcept { return 1 - own_; }

  bool sleep(std::int64_t deadline_ns) noexcept {
    const timespec deadline{deadline_ns / 1'000'000'000, deadline_ns % 1'000'000'000};
    // Said before the last look at `newest`, which the kernel takes: either it sees the new number,
    // or the writer sees this.
    memory_.sleeping[own_].store(1, std::memory_order_seq_cst);
    bool interrupted = false;
    while (!reader_.something_waits() && !interrupted && monotonic_ns() < deadline_ns) {
      interrupted =
          futex(memory_.rings[other()].newest, FUTEX_WAIT_BITSET, reader_.last(), &deadline) != 0 &&
          errno == EINTR;
    }
    memory_.sleeping[own_].store(0, std::memory_order_relaxed);
    return reader_.something_waits();
  }

  bool polls_;
  std::size_t own_;
  SharedObject object_;
  SharedMemory& memory_;
  RingWriter<ArmRing> writer_;
  RingReader<ArmRing> reader_;
};

}  // namespace

std::unique_ptr<DatagramPort> open_shared_memory_port(const std::string& url, ArmPlaneEnd end) {
  return std::make_unique<SharedMemoryPort>(parse_shared_memory_address(url), end);
}

}  // namespace limber
