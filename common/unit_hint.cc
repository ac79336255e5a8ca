#include "common/unit_hint.h"

#include <fmt/format.h>

#include <array>
#include <numbers>
#include <string_view>

namespace limber {
namespace {

struct OtherUnit {
  std::string_view ending;  ///< of the key
  std::string_view unit;    ///< as it is written in words
  std::string_view other;
  double scale;
};

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::array<OtherUnit, 8> kUnits = {{
    {"_rad_per_s", "rad/s", "degrees per second", kDegree},
    {"_m_per_s", "m/s", "millimetres per second", 1e-3},
    {"_rad", "rad", "degrees", kDegree},
    {"_kgm2", "kg m^2", "g cm^2", 1e-7},
    {"_Nm", "N m", "mN m", 1e-3},
    {"_kg", "kg", "grams", 1e-3},
    {"_m", "m", "millimetres", 1e-3},
    {"_s", "s", "milliseconds", 1e-3},
}};

}  // namespace

std::string unit_hint(const std::string& key, double value, double low, double high) {
  for (const OtherUnit& unit : kUnits) {
    if (!key.ends_with(unit.ending)) continue;
    const double inside = value * unit.scale;
    if (inside == 0.0 || !(inside >= low && inside <= high)) return "";
    return fmt::format("; are these {}? {:.4g} {} would be allowed", unit.other, inside, unit.unit);
  }
  return "";
}

}  // namespace limber
