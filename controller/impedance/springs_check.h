// Whether springs in the joints let the links be made as stiff as they are asked to be.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/types.h"
#include "robots/loader/robot.h"

#pragma GCC visibility push(default)
namespace limber::controller {

class SpringsCheck {
 public:
  explicit SpringsCheck(const Robot& robot);

  /// nullptr if springs K_J allow K (see JointSprings::taken), else how much too stiff it is, at
  /// which joint, and what to do. `gain`: K_x or K_q. The text lasts until the next call. In the
  /// cycle.
  const char* check(const char* gain, const MatrixJ& K, const VectorJ& K_J,
                    const MatrixJ& dg_dq) noexcept;

 private:
  std::vector<std::string> names_;
  std::array<char, 256> text_{};
};

}  // namespace limber::controller
#pragma GCC visibility pop
