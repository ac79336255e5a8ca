#include "drivers/can/shared_bus.h"

#include <linux/can.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <span>
#include <vector>

#include "common/clock.h"
#include "common/config_error.h"
#include "common/shared_memory/shared_object.h"
#include "drivers/can/error_frame.h"
#include "drivers/can/kernel_frame.h"
#include "drivers/can/virtual_bus.h"

namespace limber {
namespace {

/// Of a frame in a ring.
struct Times {
  std::int64_t sent_ns;   ///< CLOCK_MONOTONIC
  std::int64_t stamp_ns;  ///< CanFrame::timestamp_ns of the sender
};
static_assert(sizeof(Times) + CANFD_MTU == FrameRing::kLongest);

class SharedBus final : public CanBus {
 public:
  using CanBus::send;

  SharedBus(const SharedPlace& place, bool fd, Stamps stamps, const SharedBusOptions& options)
      : fd_(fd),
        stamps_(stamps),
        polls_(options.poll),
        object_(place, sizeof(SharedBusMemory)),
        ends_(static_cast<SharedBusMemory*>(object_.memory())->ends),
        own_(take_end(place)),
        writer_(&ends_[own_].ring) {
    for (std::size_t end = 0; end < kSharedBusEnds; ++end) {
      fifos_.push_back(open_shared_fifo({place.what, place.path + "." + std::to_string(end), ""}));
      if (end != own_) readers_.emplace_back(&ends_[end].ring);
    }
    ends_[own_].asleep.store(0);
  }

  int send(std::span<const CanFrame> frames) noexcept override {
    const std::int64_t now_ns = monotonic_ns();
    int accepted = 0;
    for (const CanFrame& frame : frames) {
      if (!is_possible(frame) || (frame.fd && !fd_)) continue;
      write(frame, now_ns);
      ++accepted;
    }
    if (accepted > 0) wake_others();
    statistics_.sent += accepted;
    statistics_.send_refused += static_cast<std::int64_t>(frames.size()) - accepted;
    return accepted;
  }

  int receive(std::span<CanFrame> frames) noexcept override {
    std::size_t taken = 0;
    statistics_.overflow = 0;
    for (RingReader<FrameRing>& reader : readers_) {
      while (taken < frames.size() && read(&reader, &frames[taken])) ++taken;
      statistics_.overflow += reader.dropped();
    }
    statistics_.received += static_cast<std::int64_t>(taken);
    return static_cast<int>(taken);
  }

  int descriptor() const noexcept override { return fifos_[own_].get(); }
  const CanStatistics& statistics() const noexcept override { return statistics_; }

  bool something_waits() const noexcept override {
    return std::ranges::any_of(readers_, &RingReader<FrameRing>::something_waits);
  }
  void about_to_sleep() noexcept override {
    std::array<std::uint8_t, 64> rung;  // by those who found this end asleep before
    static_cast<void>(::read(descriptor(), rung.data(), rung.size()));
    ends_[own_].asleep.store(1, std::memory_order_seq_cst);
  }
  bool polls() const noexcept override { return polls_; }

 private:
  std::size_t take_end(const SharedPlace& place) const {
    for (std::size_t end = 0; end < kSharedBusEnds; ++end)
      if (object_.take(static_cast<int>(end))) return end;
    throw ConfigError(place.what + ": all " + std::to_string(kSharedBusEnds) +
                      " ends are taken by other programs; stop one of them");
  }

  void write(const CanFrame& frame, std::int64_t now_ns) noexcept {
    std::array<std::uint8_t, FrameRing::kLongest> bytes;
    const Times times{now_ns, frame.timestamp_ns};
    std::memcpy(bytes.data(), &times, sizeof times);
    const std::size_t size = to_kernel(frame, std::span(bytes).subspan(sizeof times));
    writer_.write(std::span(bytes).first(sizeof times + size));
  }

  // Each end is woken once, however many find it asleep.
  void wake_others() noexcept {
    for (std::size_t end = 0; end < kSharedBusEnds; ++end) {
      std::atomic<std::uint32_t>& asleep = ends_[end].asleep;
      if (end == own_ || asleep.load(std::memory_order_seq_cst) == 0 || asleep.exchange(0) == 0)
        continue;
      static_cast<void>(::write(fifos_[end].get(), "", 1));
    }
  }

  /// The next frame for this end; false: none waits.
  bool read(RingReader<FrameRing>* reader, CanFrame* frame) noexcept {
    std::array<std::uint8_t, FrameRing::kLongest> bytes;
    for (int size = reader->read(bytes); size >= 0; size = reader->read(bytes)) {
      Times times{};
      const auto used = std::span<const std::uint8_t>(bytes).first(static_cast<std::size_t>(size));
      if (used.size() < sizeof times || !from_kernel(used.subspan(sizeof times), frame)) {
        ++statistics_.malformed;
        continue;
      }
      if (frame->fd && !fd_) continue;
      std::memcpy(&times, used.data(), sizeof times);
      frame->timestamp_ns = stamps_ == Stamps::kOnArrival ? times.sent_ns : times.stamp_ns;
      if (frame->error) count_error_frame(*frame, &statistics_);
      return true;
    }
    return false;
  }

  bool fd_;
  Stamps stamps_;
  bool polls_;
  SharedObject object_;
  std::array<SharedBusMemory::End, kSharedBusEnds>& ends_;
  std::size_t own_;
  RingWriter<FrameRing> writer_;
  std::vector<RingReader<FrameRing>> readers_;  ///< of all other ends
  std::vector<FileDescriptor> fifos_;
  CanStatistics statistics_;
};

}  // namespace

std::optional<SharedBusOptions> shared_bus_options() {
  const char* text = std::getenv("LIMBER_VIRTUAL_BUS");
  const std::string value = text == nullptr ? "udp" : text;
  if (value == "udp") return std::nullopt;
  if (value == "shm") return SharedBusOptions{false};
  if (value == "shm?poll") return SharedBusOptions{true};
  throw ConfigError("LIMBER_VIRTUAL_BUS: '" + value + "' is not known; udp, shm and shm?poll are");
}

std::string shared_bus_path(const std::string& name) {
  return "/dev/shm/limber-bus-" + virtual_bus_group(name) + "-" +
         std::to_string(virtual_bus_port());
}

std::unique_ptr<CanBus> open_shared_bus(const std::string& name, bool fd, Stamps stamps,
                                        const SharedBusOptions& options) {
  const SharedPlace place{bus_text("virtual:" + name), shared_bus_path(name), ""};
  return std::make_unique<SharedBus>(place, fd, stamps, options);
}

}  // namespace limber
