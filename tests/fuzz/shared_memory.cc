// The arm plane over shared memory, whose other end writes what it wants into the memory that both
// map: every call ends, no message is longer than a slot, nothing beyond the room is touched, and
// an end that behaves is heard again.
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <filesystem>
#include <vector>

#include "common/arm_plane/datagram_port.h"
#include "common/arm_plane/shared_memory_address.h"
#include "common/clock.h"
#include "tests/fuzz/support/fuzz_input.h"
#include "tests/fuzz/support/require.h"

using namespace limber;

namespace {

const std::string kUrl = "shm:fuzz-" + std::to_string(getpid());

/// The other end's mapping of the object, which goes away with the process.
struct Peer {
  Peer() {
    open_shared_memory_port(kUrl, ArmPlaneEnd::kDriver);
    const FileDescriptor file(open(path.c_str(), O_RDWR | O_CLOEXEC));
    void* mapped =
        mmap(nullptr, sizeof(SharedMemory), PROT_READ | PROT_WRITE, MAP_SHARED, file.get(), 0);
    fuzz::require(mapped != MAP_FAILED, "the other end maps the memory");
    memory = static_cast<SharedMemory*>(mapped);
  }
  ~Peer() {
    munmap(memory, sizeof(SharedMemory));
    std::filesystem::remove(path);
  }
  std::string path = parse_shared_memory_address(kUrl).place.path;
  SharedMemory* memory = nullptr;
};

/// A number near what it was, or any.
std::uint32_t spoilt(std::uint32_t was, fuzz::FuzzInput& in) {
  const auto step = in.take<std::int8_t>();
  return step == 0 ? in.take<std::uint32_t>() : was + static_cast<std::uint32_t>(step);
}

void spoil(SharedMemory& memory, fuzz::FuzzInput& in) {
  const auto which = in.take<std::uint8_t>();
  ArmRing& ring = memory.rings[which % 2];
  ArmRing::Slot& slot = ring.slots[in.take<std::uint8_t>() % ArmRing::kSlots];
  switch (which / 2 % 5) {
    case 0:
      ring.newest = spoilt(ring.newest, in);
      return;
    case 1:
      slot.number = spoilt(ring.newest, in);
      return;
    case 2:
      slot.bytes = spoilt(ArmRing::kLongest, in);
      return;
    case 3:
      memory.sleeping[which % 2] = in.take<std::uint32_t>();
      return;
    default:
      slot.words[in.take<std::uint8_t>() % slot.words.size()] = in.take<std::uint64_t>();
  }
}

/// False if nothing waits.
bool receive(DatagramPort& port, std::size_t room) {
  constexpr std::uint8_t kUntouched = 0xEE;
  std::vector<std::uint8_t> bytes(room);  // what is beyond it, the address sanitizer watches
  const std::int64_t dropped = port.dropped();
  const int size = port.receive(bytes);
  fuzz::require(size >= -1 && size <= static_cast<int>(ArmRing::kLongest), "a slot holds no more");
  fuzz::require(port.dropped() >= dropped, "what is dropped is counted");
  std::vector<std::uint8_t> guarded(room + 1, kUntouched);
  port.receive(std::span(guarded).first(room));
  fuzz::require(guarded.back() == kUntouched, "nothing beyond the room is touched");
  return size >= 0;
}

void drain(DatagramPort& port) {
  std::uint32_t received = 0;
  while (receive(port, ArmRing::kLongest)) ++received;
  fuzz::require(received <= ArmRing::kSlots, "no more than the ring holds");
}

void require_heard(DatagramPort& port, RingWriter<ArmRing> peer, std::size_t size) {
  const std::vector<std::uint8_t> message(size, 0x5A);
  peer.write(message);
  fuzz::require(port.wait(0), "what was sent waits");
  std::vector<std::uint8_t> heard(size + 1);
  fuzz::require(port.receive(heard) == static_cast<int>(size), "it is heard");
  heard.pop_back();
  fuzz::require(heard == message, "as it was sent");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Peer peer;
  std::memset(static_cast<void*>(peer.memory), 0, sizeof(SharedMemory));
  fuzz::FuzzInput in(data, size);
  const std::string options = in.take<std::uint8_t>() % 8 == 0 ? "?poll" : "";
  const auto port = open_shared_memory_port(kUrl + options, ArmPlaneEnd::kDriver);
  ArmRing& incoming = peer.memory->rings[1];
  while (!in.empty()) {
    const auto action = in.take<std::uint8_t>();
    const std::size_t length = in.take<std::uint16_t>() % (ArmRing::kLongest + 64);
    switch (action % 8) {
      case 0:
        receive(*port, length);
        break;
      case 1:
        port->wait(length % 4 == 0 ? monotonic_ns() + 1000 : 0);
        break;
      case 2:
        fuzz::require(
            port->send(std::vector<std::uint8_t>(length)) == (length <= ArmRing::kLongest),
            "what fits is sent");
        break;
      case 3:
        RingWriter(&incoming).write(std::vector<std::uint8_t>(length, action));
        break;
      default:
        spoil(*peer.memory, in);
    }
  }
  drain(*port);
  require_heard(*port, RingWriter(&incoming), size % ArmRing::kLongest);
  return 0;
}
