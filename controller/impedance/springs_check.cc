#include "controller/impedance/springs_check.h"

#include <fmt/format.h>

#include "controller/elastic/joint_springs.h"

namespace limber::controller {

SpringsCheck::SpringsCheck(const Robot& robot) {
  for (const JointConfig& joint : robot.joints) names_.push_back(joint.name);
}

const char* SpringsCheck::check(const char* gain, const MatrixJ& K, const VectorJ& K_J,
                                const MatrixJ& dg_dq) noexcept {
  Eigen::Index most = 0;
  const double taken = JointSprings::taken(K, K_J, dg_dq, &most);
  if (taken <= 1.0) return nullptr;
  *fmt::format_to_n(text_.data(), text_.size() - 1,
                    FMT_STRING("{} is {:.2g} % more than the joints' springs, less the weight, "
                               "allow in this pose ({} most): lower it, or choose "
                               "position_feedback motor, which takes more in series with them"),
                    gain, 100.0 * (taken - 1.0), names_[static_cast<std::size_t>(most)])
       .out = '\0';
  return text_.data();
}

}  // namespace limber::controller
