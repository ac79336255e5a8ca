// The start-up dialogue of a CANopen drive as a table: what is written, what is compared.
//
//   NMT pre-operational -> power stage off -> is it the drive that robot.yaml describes ->
//   mode, limit, watchdog, period, torque loop: written and read back -> PDOs mapped ->
//   NMT start, answered by the first TPDOs
//
// All by SDO (CiA 301), one transfer after the other, each with a second's time. Objects that the
// profile leaves to the maker may be missing. Allowed inside the cycle: everything but the
// constructor and describe().
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "drivers/families/drive_family.h"
#include "drivers/protocols/canopen_sdo.h"
#include "drivers/protocols/cia402_pdos.h"

namespace limber {

/// Thousandths of the rated torque that the joint's limit allows; more is never commanded.
std::uint32_t most_permille(const JointConfig& joint) noexcept;

class Cia402Startup {
 public:
  Cia402Startup(const JointConfig& joint, const cia402::StateLayout& layout, double period_s);

  int patience_cycles() const noexcept { return patience_cycles_; }
  int startup_steps() const noexcept { return static_cast<int>(steps_.size()); }
  StartupStep startup_step(int index) const noexcept;
  CanFrame startup_request(int index) const noexcept;
  /// What is compared, and the mode in force; of the state the power is awaited to be off.
  bool may_be_read_again(int index) const noexcept;
  /// The NMT start, which the first state answers; all others are check_answer()'s.
  bool is_start(int index) const noexcept { return step(index).kind == Kind::kStart; }
  Answer check_answer(int index, const CanFrame& frame, double* found) noexcept;
  /// "object 6076h:00 is 10000, expected 28000".
  std::string describe(const StartupFailure& failure) const;

 private:
  enum class Kind : std::uint8_t {
    kPreOperational,
    kWrite,
    kCompare,  ///< the bits of the mask, of what is read, with the value
    kAwait,    ///< likewise; a drive may take its time
    kCounts,   ///< one of the numbers that make counts per turn; at the last, that is compared
    kStart,
  };
  /// If the drive has no such object.
  enum class Absence : std::uint8_t {
    kRefused,
    kWarned,
    kSilent,  ///< nothing to write, or 1
  };
  enum class Number : std::uint8_t { kUnsigned, kSigned, kFloat };
  struct Step {
    Kind kind;
    canopen::Object object = {};
    std::uint32_t value = 0;
    std::uint32_t mask = 0xFFFFFFFF;
    Number number = Number::kUnsigned;
    Absence absence = Absence::kRefused;
  };

  void plan_identity(const JointConfig& joint);
  void plan_settings(const JointConfig& joint, double period_s);
  void plan_torque_loop(const JointConfig& joint);
  void plan_pdo(std::uint16_t communication, std::uint16_t mapping, std::uint32_t id,
                std::span<const canopen::Object> objects);
  void switch_off_tpdo(int k);
  void write(const canopen::Object& object, std::uint32_t value,
             Absence absence = Absence::kRefused);
  void write_and_compare(const canopen::Object& object, std::uint32_t value,
                         Number number = Number::kUnsigned, Absence absence = Absence::kRefused);
  void compare(const canopen::Object& object, std::uint32_t value, std::uint32_t mask = 0xFFFFFFFF);
  void await(const canopen::Object& object, std::uint32_t value, std::uint32_t mask = 0xFFFFFFFF);

  const Step& step(int index) const noexcept { return steps_[static_cast<std::size_t>(index)]; }
  static double value_of(const Step& step, std::uint32_t raw) noexcept;
  Answer check_absence(const Step& planned, std::uint32_t abort_code, double* found) noexcept;
  Answer check_counts(const Step& planned, std::uint32_t value, double* found) noexcept;

  std::uint8_t node_;
  int tpdos_;
  double counts_per_turn_;
  int patience_cycles_;
  std::vector<Step> steps_;
  std::array<double, 4> counts_read_{};  ///< in the order of their steps
};

}  // namespace limber
