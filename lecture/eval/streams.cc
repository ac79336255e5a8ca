// The goal of one joint along a target stream, sample by sample.
#include <cmath>
#include <string>
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

const Json& list_in(const Json& object, const char* key) {
  if (!object.contains(key) || !object[key].is_array())
    refuse("messages", std::string("a list ") + key, object);
  return object[key];
}

/// "arrivals": s; "times", "positions": a list a message, s and rad.
std::vector<Arriving> read_messages(const Json& object) {
  const Json& arrivals = list_in(object, "arrivals");
  const Json& times = list_in(object, "times");
  const Json& positions = list_in(object, "positions");
  if (times.size() != arrivals.size() || positions.size() != arrivals.size())
    refuse("messages", "three lists of one length", object);
  std::vector<Arriving> messages;
  for (std::size_t m = 0; m < arrivals.size(); ++m) {
    if (!times[m].is_array() || times[m].empty()) refuse("messages: times", "a list", times[m]);
    const auto size = static_cast<Eigen::Index>(times[m].size());
    const Eigen::VectorXd t = read_vector("messages: times", times[m], size);
    const Eigen::VectorXd x = read_vector("messages: positions", positions[m], size);
    messages.push_back({nanoseconds(read_number("messages: arrivals", arrivals[m])), {}});
    for (Eigen::Index i = 0; i < size; ++i)
      messages.back().knots.push_back({nanoseconds(t[i]), one(x[i])});
  }
  return messages;
}

}  // namespace

Json target_stream_seq(Inputs& in) {
  const auto samples = static_cast<int>(in.positive("n"));
  StreamMotion<JointSpace> motion({one(in.positive("v_fade")), one(in.positive("a_fade")),
                                   one(in.positive("v_max")), one(in.positive("a_max"))});
  motion.reset(JointSpace::at_rest(one(in.number("x0"))), -kStep_ns);
  const std::vector<Arriving> messages = read_messages(in.object("messages"));
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
