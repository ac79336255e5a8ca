#include "controller/observers/coriolis_transpose.h"

namespace limber::controller {
namespace {

constexpr double kAlongSpeed = 1e-5;  // rad or m along v

}  // namespace

VectorJ coriolis_transpose(ArmModel* model, const ArmTerms& terms, const VectorJ& q,
                           const VectorJ& v) noexcept {
  const double speed = v.norm();
  if (!(speed > 0.0)) return -terms.Cv;
  const VectorJ step = (kAlongSpeed / speed) * v;
  const MatrixJ ahead = model->mass(q + step);
  const MatrixJ behind = model->mass(q - step);
  return (0.5 * speed / kAlongSpeed) * (ahead - behind) * v - terms.Cv;
}

}  // namespace limber::controller
