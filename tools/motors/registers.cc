#include "tools/motors/registers.h"

#include <fmt/format.h>

#include <bit>
#include <limits>

namespace limber::motor_tools {
namespace {

std::string text_of(std::uint32_t raw, Format format) {
  if (format == Format::kFloat) return fmt::format("{}", std::bit_cast<float>(raw));
  if (format == Format::kInt16) return std::to_string(static_cast<std::int16_t>(raw));
  return std::to_string(raw & static_cast<std::uint32_t>(range_of(format).high));
}

}  // namespace

std::vector<Setting> RegisterTool::settings(Wire* wire, int number, bool fd) const {
  std::vector<Setting> settings;
  for (const StoredRegister& reg : stored()) {
    const auto raw = try_read(wire, number, reg.number, fd);
    settings.push_back(
        {reg.name, raw ? text_of(*raw, reg.format) : "", reg.use, reg.format, reg.robot_key});
  }
  return settings;
}

void RegisterTool::write(Wire* wire, int number, const Setting& setting, double value,
                         bool fd) const {
  const std::uint32_t raw = setting.format == Format::kFloat
                                ? std::bit_cast<std::uint32_t>(static_cast<float>(value))
                                : static_cast<std::uint32_t>(static_cast<std::int64_t>(value));
  for (const StoredRegister& reg : stored())
    if (reg.name == setting.name) put(wire, number, reg, raw, fd);
}

double RegisterTool::read_float(Wire* wire, int number, std::uint32_t reg, bool fd) const {
  const auto raw = try_read(wire, number, reg, fd);
  return raw ? std::bit_cast<float>(*raw) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace limber::motor_tools
