#include "scenarios/loader/stream_yaml.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenarios/loader/scenario.h"
#include "scenarios/loader/values_yaml.h"

namespace limber {
namespace {

constexpr int kMostKnots = 16;
constexpr int kPositionColumns = 3;

/// A row of `columns` numbers a knot, from column `first` of the message's on.
void read_rows(const YamlMap& yaml, const std::string& key, int columns, int first, Range range,
               target_stream_t* stream) {
  const auto rows = yaml.matrix(key, stream->num_knots, columns, range);
  for (int i = 0; i < stream->num_knots; ++i) {
    for (int j = 0; j < columns; ++j) {
      stream->value[i][first + j] =
          static_cast<float>(rows[static_cast<std::size_t>(i * columns + j)]);
    }
  }
}

void read_values(const YamlMap& yaml, const Robot& robot, target_stream_t* stream) {
  const bool joints = yaml.has("joints_rad"), pose = yaml.has("position_m");
  const bool twist = yaml.has("twist");
  if (joints + pose + twist != 1)
    yaml.refuse("expected one of: joints_rad, position_m with quaternion_wxyz, twist");
  if (joints) {
    stream->kind = target_stream_t::KIND_JOINTS;
    read_rows(yaml, "joints_rad", robot.size(), 0, {-1e3, 1e3}, stream);
  } else if (twist) {
    stream->kind = target_stream_t::KIND_TWIST;
    read_rows(yaml, "twist", 6, 0, {-10.0, 10.0}, stream);
  } else {
    stream->kind = target_stream_t::KIND_POSE;
    read_rows(yaml, "position_m", kPositionColumns, 0, kPositionRange_m, stream);
    read_rows(yaml, "quaternion_wxyz", 4, kPositionColumns, {-1.001, 1.001}, stream);
  }
}

void read_six(const YamlMap& yaml, target_stream_t* stream) {
  double F[6] = {};
  read_three(yaml, "force_N", kForceRange_N, F);
  read_three(yaml, "torque_Nm", kTorqueRange_Nm, F + 3);
  std::transform(F, F + 6, stream->F_ff, [](double x) { return static_cast<float>(x); });
}

}  // namespace

target_stream_t read_stream(const YamlMap& yaml, const Robot& robot) {
  target_stream_t stream{};
  stream.client = kScenarioClient;
  stream.num_joints = static_cast<std::int8_t>(robot.size());
  const auto times = yaml.numbers("dt_s", -1, {0.0, 10.0});
  if (times.empty() || times.size() > kMostKnots)
    yaml.refuse("dt_s", fmt::format("has {} times; expected 1 to {}", times.size(), kMostKnots));
  stream.num_knots = static_cast<std::int8_t>(times.size());
  std::transform(times.begin(), times.end(), stream.dt_s,
                 [](double t) { return static_cast<float>(t); });
  read_values(yaml, robot, &stream);
  stream.t0_ns = yaml.has("t0_s") ? std::llround(1e9 * yaml.number("t0_s", {0.0, 1e6}))
                                  : std::int64_t{target_stream_t::NOW};
  if (yaml.has("hand_width_m")) {
    const auto widths = yaml.numbers("hand_width_m", stream.num_knots, {-0.02, 1.0}, true);
    std::transform(widths.begin(), widths.end(), stream.hand_width_m,
                   [](double w) { return static_cast<float>(w); });
    stream.use_hand = 1;
  }
  stream.hand_force_N = static_cast<float>(yaml.number_or("hand_force_N", {0.0, 1e3}, 0.0));
  stream.delay_s = static_cast<float>(yaml.number_or("delay_s", {0.0, 2.0}, 0.0));
  stream.valid_for_s = static_cast<float>(yaml.number_or("valid_for_s", {0.0, 600.0}, 0.0));
  stream.stiffness_scale = static_cast<float>(yaml.number_or("stiffness_scale", {0.05, 1.0}, 0.0));
  read_six(yaml, &stream);
  yaml.finish();
  return stream;
}

}  // namespace limber
