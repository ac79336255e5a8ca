// The memory that driver and controller share: /dev/shm/limber-arm-NAME.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>

#include "common/arm_plane/datagram_port.h"
#include "common/arm_plane/shared_ring.h"
#include "common/file_descriptor.h"

namespace limber {

/// shm:NAME, with ?poll, ?group=GROUP or ?poll&group=GROUP.
struct SharedMemoryAddress {
  std::string name;   ///< letters, digits, '-' and '_'
  std::string group;  ///< whose members may have the other end; empty: this user alone
  bool poll = false;  ///< this end spins while it waits

  std::string path() const { return "/dev/shm/limber-arm-" + name; }
};

/// Throws ConfigError. Set-up only.
SharedMemoryAddress parse_shared_memory_address(const std::string& url);

/// All of it 0: nothing was sent. Each end writes the ring and the holder of its number.
struct SharedMemory {
  std::array<SharedRing, 2> rings;
  std::array<std::atomic<std::uint32_t>, 2> holders;  ///< processes; for messages to people alone
};

/// One end's mapping. The object outlives all processes, so that each finds it again, whichever was
/// started anew; what lies in it from before is not read. Set-up only.
class SharedObject {
 public:
  /// Opens the object, or makes it, and takes this end until the process ends, however that
  /// happens. Throws ConfigError: the end is taken; the object is neither this user's nor root's
  /// nor of the address's group; others may write to it; another version of limber made it.
  SharedObject(const SharedMemoryAddress& address, ArmPlaneEnd end);
  ~SharedObject();
  SharedObject(const SharedObject&) = delete;
  SharedObject& operator=(const SharedObject&) = delete;

  SharedMemory* operator->() const noexcept { return memory_; }

 private:
  FileDescriptor file_;
  SharedMemory* memory_ = nullptr;
};

}  // namespace limber
