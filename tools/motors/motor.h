// One motor on a bus, by its word "damiao_mit:3".
#pragma once

#include <functional>
#include <string>

#include "tools/motors/motor_tool.h"

namespace limber::motor_tools {

struct Motor {
  const MotorTool* tool = nullptr;
  int number = 0;

  std::string word() const;
};

struct BusChoice {
  std::string address;
  bool fd = false;
};

/// Throws ConfigError if the word is none.
Motor motor_of(const std::string& word);

/// Throws as Wire does; ConfigError if the tool's motors need another bus.
Wire open(const BusChoice& bus, const MotorTool* tool = nullptr);
/// Calls every number of every family; `found` is called once for each answer.
void scan(Wire* wire, bool fd, const std::function<void(const Motor&, const Found&)>& found);
/// All that answer. Throws std::runtime_error if two have one number.
std::vector<Motor> motors_on(Wire* wire, bool fd);
bool answers(const Motor& motor, Wire* wire, bool fd);
/// Throws std::runtime_error.
void require_answer(const Motor& motor, Wire* wire, bool fd);
/// Throws std::runtime_error if its power stage is on.
void require_off(const Motor& motor, Wire* wire, bool fd);
/// settings() of its tool, which answers to the end.
std::vector<Setting> settings_of(const Motor& motor, Wire* wire, bool fd);

}  // namespace limber::motor_tools
