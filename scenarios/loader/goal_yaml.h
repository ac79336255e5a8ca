// `goal:` of a scenario's timeline.
#pragma once

#include <limber/compliance_goal_t.hpp>

#include "common/yaml_reader.h"
#include "robots/loader/robot.h"

namespace limber {

/// One of: offset_m and/or offset_rad; position_m and quaternion_wxyz; joints_rad; circle_centre_m
/// (from the present goal) and circle_axis, with duration_s as the period; with force_N
/// and torque_Nm as feed-forward (zero if not named), which may also stand alone. posture_rad goes
/// with the first two. Without seq. Set-up only.
compliance_goal_t read_goal(const YamlMap& yaml, const Robot& robot);

}  // namespace limber
