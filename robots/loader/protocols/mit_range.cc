#include "robots/loader/protocols/mit_range.h"

namespace limber {

CommandRange read_mit_range(const YamlMap& yaml) {
  CommandRange range;
  range.position_rad = yaml.number("position_rad", {1.0, 200.0});
  range.velocity_rad_per_s = yaml.number("velocity_rad_per_s", {0.1, 1000.0});
  range.torque_Nm = yaml.number("torque_Nm", {0.01, 5e4});
  range.kp_Nm_per_rad = yaml.number("kp_Nm_per_rad", {1.0, 5000.0});
  range.kd_Nms_per_rad = yaml.number("kd_Nms_per_rad", {0.01, 500.0});
  yaml.finish();
  return range;
}

}  // namespace limber
