// Start-up dialogue with one drive: before anything is enabled, both sides must mean the same by
// the same bits, and the drive must stop by itself when it hears nothing.
//
//   disable -> PMAX, VMAX, TMAX equal robot.yaml -> CTRL_MODE := MIT, read back
//           -> TIMEOUT := watchdog_s, read back -> done
//
// It starts with disable because a motor may still be enabled by a process that died; the enabled
// state of a stranger is never taken over. One frame a cycle. Allowed inside the cycle: everything
// but the constructor.
#pragma once

#include <array>
#include <cstdint>

#include "drivers/can/can_frame.h"
#include "drivers/protocols/mit.h"
#include "robots/robot.h"

namespace limber {

class ConfigureDialogue {
 public:
  ConfigureDialogue(const DriveConfig& drive, bool fd);

  void start() noexcept;

  /// The frame of this cycle.
  CanFrame next_frame() const noexcept;
  /// True if a state reply, not a register answer, is expected.
  bool expects_state() const noexcept { return step_ == 0 || done(); }
  /// A register answer; false if it is not the one asked for.
  bool receive(const CanFrame& frame) noexcept;
  /// A state reply.
  void receive_state(bool enabled) noexcept;
  /// End of a cycle: an unanswered request is repeated, three times at most.
  void close_cycle() noexcept;

  bool done() const noexcept { return step_ == kSteps; }
  bool failed() const noexcept { return failed_; }

  /// What the dialogue failed at: register (0 for the disabling), what the drive said (0 if
  /// nothing) and what it should have said.
  struct Failure {
    std::uint8_t reg = 0;
    bool answered = false;
    double found = 0.0;
    double expected = 0.0;
  };
  const Failure& failure() const noexcept { return failure_; }

 private:
  enum class Kind : std::uint8_t { kDisable, kCompareRange, kWrite, kReadBack };
  struct Step {
    Kind kind;
    mit::Register reg;
    std::uint32_t raw;  ///< expected or written
  };
  static constexpr int kSteps = 8;
  static constexpr int kAttempts = 4;

  bool agrees(const Step& step, std::uint32_t raw) const noexcept;
  void fail(bool answered, std::uint32_t raw) noexcept;
  void advance() noexcept;

  std::array<Step, kSteps> steps_;
  std::uint16_t id_;
  bool fd_;
  int step_ = 0;
  int attempts_ = 0;
  bool advanced_ = false;  ///< in this cycle
  bool failed_ = false;
  Failure failure_;
};

}  // namespace limber
