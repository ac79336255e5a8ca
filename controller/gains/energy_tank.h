// Lets stiffness grow only with energy that the damper has taken out before.
#pragma once

#include "common/types.h"

namespace limber::controller {

/// Raising the stiffness K by dK at the error e puts dU = e^T dK e / 2 into the arm. The tank E
/// pays for it (Ferraguti, Secchi, Fantuzzi 2013). Each sample, in this order:
///   dU = e^T (K_req - K) e / 2
///   fill  E = min(E_max, E + share T V^T D V)
///   dU <= 0: K = K_req; what a softer spring gives back is not stored
///   dU > 0:  K += phi (K_req - K), E -= phi dU,
///            phi = 1 if E - dU >= E_min, else (E - E_min) / dU.
/// Energy of arm and spring then never exceeds what it was at the start plus the first filling.
class EnergyTank {
 public:
  /// Energies in J; share: part of the dissipated energy that is stored, 0 to 1.
  struct Config {
    double E_0;
    double E_min;
    double E_max;
    double share;
  };

  /// K: stiffness at the start, m x m, m <= kMaxJoints. Throws ConfigError unless
  /// 0 <= E_min <= E_0 <= E_max and 0 <= share <= 1.
  EnergyTank(const Config& config, const MatrixJ& K);

  /// D: m x m; e and V: error and its rate, m; T in s. Returns the stiffness to use. A sample that
  /// is not finite changes nothing. May be called in the cycle.
  const MatrixJ& update(const MatrixJ& K_req, const MatrixJ& D, const VectorJ& e, const VectorJ& V,
                        double T) noexcept;

  const MatrixJ& stiffness() const noexcept { return K_; }
  double energy_J() const noexcept { return E_; }

 private:
  Config config_;
  MatrixJ K_;
  double E_;
};

}  // namespace limber::controller
