#include "controller/kinds/gains.h"

namespace limber::controller {

Gains::Gains(int joints, LawRows rows)
    : K_q(MatrixJ::Zero(joints, joints)),
      D_q(K_q),
      K_null(K_q),
      D_null(K_q),
      settings(default_settings()),
      parameters(joints, rows) {}

}  // namespace limber::controller
