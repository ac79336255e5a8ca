// Families whose settings are numbered registers of four bytes at most.
#pragma once

#include "tools/motors/motor_tool.h"

namespace limber::motor_tools {

/// A register, parameter or object, by the maker's manual.
struct StoredRegister {
  std::uint32_t number;
  std::string name;
  Format format;
  Setting::Use use;
  std::string robot_key = {};
};

class RegisterTool : public MotorTool {
 public:
  std::vector<Setting> settings(Wire* wire, int number, bool fd) const override;
  void write(Wire* wire, int number, const Setting& setting, double value, bool fd) const final;

 protected:
  virtual const std::vector<StoredRegister>& stored() const = 0;
  /// Nothing: not in its firmware.
  virtual std::optional<std::uint32_t> try_read(Wire* wire, int number, std::uint32_t reg,
                                                bool fd) const = 0;
  /// Throws std::runtime_error if it is not answered or refused.
  virtual void put(Wire* wire, int number, const StoredRegister& reg, std::uint32_t raw,
                   bool fd) const = 0;
  /// NaN: not in its firmware.
  double read_float(Wire* wire, int number, std::uint32_t reg, bool fd) const;
};

}  // namespace limber::motor_tools
