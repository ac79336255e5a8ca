// The settings of the motors on a bus as a YAML file for version control, and back.
#pragma once

#include <string>
#include <vector>

#include "tools/motors/motor.h"

namespace limber::motor_tools {

inline constexpr const char* kFormat = "limber-motors/1";
/// Of a motor in the file.
inline constexpr std::pair<const char*, Setting::Use> kSections[] = {
    {"model", Setting::Use::kModel},
    {"settings", Setting::Use::kWritable},
    {"compared", Setting::Use::kOther}};

/// The file's text: of every motor that answers on these buses. Nothing is written to them. Throws
/// as motors_on() and settings_of() do, std::runtime_error if no motor answers.
std::string dump(const std::vector<BusChoice>& buses);

/// Prints how the motors differ from the file, and writes what is writable and differs; each is
/// read back. Before anything is written it throws ConfigError if the file is not whole or a value
/// does not fit, std::runtime_error if a motor of the file does not answer, is of another model, or
/// has its power stage on. Later: if a motor refuses a value.
void restore(const std::string& path);

}  // namespace limber::motor_tools
