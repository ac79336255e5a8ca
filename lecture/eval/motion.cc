// Goals that move smoothly, and the force of a contact.
#include <cmath>

#include "common/config_error.h"
#include "common/contact_law.h"
#include "controller/goals/interpolation.h"
#include "lecture/eval/inputs.h"

namespace limber::eval {
namespace {

using namespace controller;

Eigen::Vector3d unit_vector(Inputs& in, const std::string& key) {
  constexpr double kNotUnit = 1e-6;
  const Eigen::Vector3d vector = in.vector(key, 3);
  if (!(std::abs(vector.norm() - 1.0) <= kNotUnit))
    throw ConfigError(key + ": expected a unit vector, found one of length " +
                      std::to_string(vector.norm()));
  return vector;
}

}  // namespace

Json interpolation(Inputs& in) {
  const Pose start{in.vector("p0", 3), in.rotation("R0")};
  const Pose end{in.vector("p1", 3), in.rotation("R1")};
  PoseMotion motion;
  motion.reset(start);
  motion.start(end, in.positive("T"));
  motion.advance(in.not_negative("t"));
  return {{"p", list_of(motion.X_BD.p)},         {"v", list_of(motion.V_BD.head<3>())},
          {"a", list_of(motion.A_BD.head<3>())}, {"R", rows_of(motion.X_BD.Q.toRotationMatrix())},
          {"w", list_of(motion.V_BD.tail<3>())}, {"alpha", list_of(motion.A_BD.tail<3>())}};
}

Json contact(Inputs& in) {
  const Eigen::Vector3d n = unit_vector(in, "n");
  const Approach at(in.vector("p", 3), in.vector("v", 3), in.vector("p0", 3), n);
  const double k = in.not_negative("k");
  const double b = in.not_negative("b");
  const double k_hc = in.not_negative("k_hc");
  const double c = in.not_negative("b_hc");
  return {{"f_kv", list_of(kelvin_voigt(at, k, b) * n)},
          {"f_hc", list_of(hunt_crossley(at, k_hc, c) * n)}};
}

}  // namespace limber::eval
