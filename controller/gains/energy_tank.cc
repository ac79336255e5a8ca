#include "controller/gains/energy_tank.h"

#include <algorithm>
#include <cmath>

#include "common/config_error.h"

namespace limber::controller {

EnergyTank::EnergyTank(const Config& config, const MatrixJ& K)
    : config_(config), K_(K), E_(config.E_0) {
  if (!(config.E_min >= 0.0 && config.E_min <= config.E_0 && config.E_0 <= config.E_max &&
        std::isfinite(config.E_max))) {
    throw ConfigError("an energy tank needs 0 <= E_min <= E_0 <= E_max");
  }
  if (!(config.share >= 0.0 && config.share <= 1.0)) {
    throw ConfigError("an energy tank stores a share of 0 to 1");
  }
}

const MatrixJ& EnergyTank::update(const MatrixJ& K_req, const MatrixJ& D, const VectorJ& e,
                                  const VectorJ& V, double T) noexcept {
  const MatrixJ dK = K_req - K_;
  const double dU = 0.5 * e.dot(dK * e);
  const double gain = config_.share * T * V.dot(D * V);
  if (!dK.allFinite() || !std::isfinite(dU) || !std::isfinite(gain)) return K_;
  E_ = std::min(config_.E_max, E_ + gain);
  if (dU <= 0.0) {
    K_ = K_req;
    return K_;
  }
  const double phi = std::clamp((E_ - config_.E_min) / dU, 0.0, 1.0);
  K_ += phi * dK;
  E_ -= phi * dU;
  return K_;
}

}  // namespace limber::controller
