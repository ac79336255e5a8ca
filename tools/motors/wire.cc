#include "tools/motors/wire.h"

#include <fmt/format.h>

#include <array>
#include <stdexcept>

#include "common/clock.h"

namespace limber::motor_tools {
namespace {

constexpr double kSecond_ns = 1e9;

}  // namespace

Wire::Wire(const std::string& address, bool fd, Accept unasked)
    : address_(address), unasked_(std::move(unasked)), bus_(open_can_bus(address, fd)) {
  require_quiet(kQuiet_s);
}

void Wire::require_quiet(double wait_s) {
  std::optional<CanFrame> foreign;
  listen(wait_s, [&](const CanFrame& frame) {
    if (!frame.error && !unasked_(frame)) foreign = frame;
    return foreign.has_value();
  });
  if (foreign)
    throw std::runtime_error(fmt::format(
        "{}: somebody sends on this bus (identifier {:X}): end the stack, or the other program, "
        "first",
        address_, foreign->id));
}

void Wire::listen(double wait_s, const std::function<bool(const CanFrame&)>& heard) {
  const std::int64_t end_ns = monotonic_ns() + static_cast<std::int64_t>(wait_s * kSecond_ns);
  const std::array<CanBus*, 1> buses = {bus_.get()};
  std::array<CanFrame, 64> frames;
  do {
    const int count = bus_->receive(frames);
    for (int i = 0; i < count; ++i)
      if (heard(frames[static_cast<std::size_t>(i)])) return;
  } while (wait_readable(buses, end_ns) || monotonic_ns() < end_ns);
}

void Wire::put(const CanFrame& frame) {
  if (bus_->send(frame) != 1)
    throw std::runtime_error(address_ +
                             ": the bus takes no frames; is the interface up, and does anybody "
                             "acknowledge? (ip -details link show)");
}

std::optional<CanFrame> Wire::await(const Accept& accept, double wait_s) {
  std::optional<CanFrame> found;
  listen(wait_s, [&](const CanFrame& frame) {
    if (!frame.error && accept(frame)) found = frame;
    return found.has_value();
  });
  return found;
}

std::optional<CanFrame> Wire::ask(const CanFrame& request, const Accept& accept) {
  for (int attempt = 0; attempt < kTries; ++attempt) {
    put(request);
    if (auto answer = await(accept, kAnswer_s)) return answer;
  }
  return std::nullopt;
}

void Wire::send(const CanFrame& frame, double wait_s,
                const std::function<void(const CanFrame&)>& heard) {
  put(frame);
  listen(wait_s, [&](const CanFrame& answer) {
    if (!answer.error) heard(answer);
    return false;
  });
}

}  // namespace limber::motor_tools
