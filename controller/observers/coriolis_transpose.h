// The Coriolis term that momentum has and acceleration has not.
#pragma once

#include "controller/model/arm_terms.h"

namespace limber::controller {

/// C^T v = (dM/dt) v - C v, N m, since dM/dt = C + C^T; dM/dt by a central difference of M along v
/// (two evaluations of M; relative error about 1e-10). `terms` hold Cv at (q, v). Constant rotor
/// inertias change nothing. May be called in the cycle.
VectorJ coriolis_transpose(ArmModel* model, const ArmTerms& terms, const VectorJ& q,
                           const VectorJ& v) noexcept;

}  // namespace limber::controller
