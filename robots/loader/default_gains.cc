#include "robots/loader/default_gains.h"

#include <algorithm>
#include <string>

#include "common/config_error.h"
#include "lcmtypes/gains_table.h"

namespace limber {

compliance_gains_t default_gains(const Robot& robot) {
  const DefaultGains& defaults = robot.gains;
  const auto n = static_cast<std::size_t>(robot.size());
  if (defaults.K_q.size() != n || defaults.K_null.size() != n || defaults.D_null.size() != n) {
    throw ConfigError(robot.name +
                      ": gains: K_q, K_null and D_null need one value for each of the " +
                      std::to_string(n) + " joints");
  }
  compliance_gains_t gains = standard_gains();
  gains.num_joints = static_cast<std::int8_t>(n);
  for (int i = 0; i < 6; ++i) {
    gains.K_x[i][i] = i < 3 ? defaults.K_x_translation_N_per_m : defaults.K_x_rotation_Nm_per_rad;
  }
  gains.damping_ratio = defaults.damping_ratio;
  gains.joint_damping_ratio = defaults.joint_damping_ratio;
  std::copy(defaults.K_q.begin(), defaults.K_q.end(), gains.K_q);
  std::copy(defaults.K_null.begin(), defaults.K_null.end(), gains.K_null);
  std::copy(defaults.D_null.begin(), defaults.D_null.end(), gains.D_null);
  return gains;
}

}  // namespace limber
