// The goal of one joint along a target stream, sample by sample.
#include <cmath>
#include <vector>

#include "common/config_error.h"
#include "controller/goals/stream/stream_motion.h"
#include "lecture/eval/inputs.h"
#include "lecture/eval/shapes.h"

namespace limber::eval {
namespace {

using namespace controller;

constexpr std::int64_t kStep_ns = 1'000'000;
constexpr double kStep_s = 1e-3;

VectorJ one(double x) { return VectorJ::Constant(1, x); }

struct Arriving {
  std::int64_t time_ns;
  std::vector<Knot<JointSpace>> knots;
};

std::int64_t nanoseconds(double s) { return std::llround(1e9 * s); }

/// [arrival, [knot times], [positions]], s and rad.
Arriving read_message(const Json& row) {
  if (!row.is_array() || row.size() != 3 || !row[1].is_array() || row[1].empty())
    refuse("messages", "[arrival, [times], [positions]]", row);
  const auto size = static_cast<Eigen::Index>(row[1].size());
  const Eigen::VectorXd times = read_vector("messages: times", row[1], size);
  const Eigen::VectorXd x = read_vector("messages: positions", row[2], size);
  Arriving message{nanoseconds(read_number("messages: arrival", row[0])), {}};
  for (Eigen::Index i = 0; i < size; ++i)
    message.knots.push_back({nanoseconds(times[i]), one(x[i])});
  return message;
}

}  // namespace

Json target_stream_seq(Inputs& in) {
  const auto samples = static_cast<int>(in.positive("n"));
  StreamMotion<JointSpace> motion({one(in.positive("v_fade")), one(in.positive("a_fade")),
                                   one(in.positive("v_max")), one(in.positive("a_max"))});
  motion.reset(JointSpace::at_rest(one(in.number("x0"))), -kStep_ns);
  std::vector<Arriving> messages;
  for (const Json& row : in.object("messages")) messages.push_back(read_message(row));
  Json x = Json::array(), v = Json::array(), a = Json::array();
  std::size_t next = 0;
  for (int i = 0; i < samples; ++i) {
    for (; next < messages.size() && messages[next].time_ns <= i * kStep_ns; ++next) {
      if (!motion.take(messages[next].knots)) throw ConfigError("messages: too many knots wait");
    }
    if (motion.active()) motion.advance(i * kStep_ns, kStep_s, one(1e9), one(1e9));
    x.push_back(motion.goal().x[0]);
    v.push_back(motion.goal().v[0]);
    a.push_back(motion.goal().a[0]);
  }
  return {{"x", x}, {"v", v}, {"a", a}};
}

}  // namespace limber::eval
