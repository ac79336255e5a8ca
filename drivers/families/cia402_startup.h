// The start-up dialogue of a CANopen drive as a table: what is written, what is compared.
//
//   NMT pre-operational -> power stage off -> is it the drive that robot.yaml describes ->
//   mode, limit, watchdog, period, torque loop: written and read back -> PDOs mapped ->
//   NMT start, answered by the first TPDO1
//
// All by SDO (CiA 301), one transfer after the other. Allowed inside the cycle: everything but the
// constructor and describe().
#pragma once

#include <span>
#include <string>
#include <vector>

#include "drivers/families/drive_family.h"
#include "drivers/protocols/canopen_sdo.h"

namespace limber {

/// Thousandths of the rated torque that the joint's limit allows; more is never asked for.
std::uint32_t most_permille(const JointConfig& joint) noexcept;

class Cia402Startup {
 public:
  Cia402Startup(const JointConfig& joint, double period_s);

  int patience_cycles() const noexcept { return patience_cycles_; }
  int questions() const noexcept { return static_cast<int>(steps_.size()); }
  StartupQuestion question(int index) const noexcept;
  CanFrame ask(int index) const noexcept;
  Answer judge(int index, const CanFrame& frame, double* found) const noexcept;
  /// "object 6076h:00 is 10000, expected 28000".
  std::string describe(const StartupFailure& failure) const;

 private:
  enum class Kind : std::uint8_t {
    kPreOperational,
    kWrite,
    kCompare,  ///< the bits of the mask, of what is read, with the value
    kAwait,    ///< likewise; a drive may take its time
    kStart,
  };
  enum class Number : std::uint8_t { kUnsigned, kSigned, kFloat };
  struct Step {
    Kind kind;
    canopen::Object object;
    std::uint32_t value;
    std::uint32_t mask;
    Number number;
  };

  void plan_identity(const JointConfig& joint);
  void plan_settings(const JointConfig& joint, double period_s);
  void plan_torque_loop(const JointConfig& joint);
  void plan_pdo(std::uint16_t communication, std::uint16_t mapping, std::uint32_t id,
                std::span<const canopen::Object> objects);
  void write(const canopen::Object& object, std::uint32_t value);
  void write_and_compare(const canopen::Object& object, std::uint32_t value,
                         Number number = Number::kUnsigned);
  void compare(const canopen::Object& object, std::uint32_t value, std::uint32_t mask = 0xFFFFFFFF);
  void await(const canopen::Object& object, std::uint32_t value, std::uint32_t mask = 0xFFFFFFFF);

  const Step& step(int index) const noexcept { return steps_[static_cast<std::size_t>(index)]; }
  static double value_of(const Step& step, std::uint32_t raw) noexcept;
  Answer judge_started(const CanFrame& frame) const noexcept;

  std::uint8_t node_;
  std::uint32_t state_id_;
  bool link_encoder_;
  int patience_cycles_;
  std::vector<Step> steps_;
};

}  // namespace limber
