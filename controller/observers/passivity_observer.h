// Counts the energy a sampled controller makes, and the damping that takes it back.
#pragma once

#include <algorithm>
#include <limits>

#include "common/types.h"

namespace limber::controller {

/// Passivity observer and controller (Hannaford and Ryu 2002). f: the controller's force on the
/// robot, held from one sample to the next; x: displacement it acts along:
///   E_k = E_{k-1} - f_{k-1} . (x_k - x_{k-1})
/// is what the controller has taken in. Negative: it has made energy. A spring K held for T makes
/// (K T / 2) times the integral of v^2. Joint torque and q, or a force and p; VectorJ or Vector6.
/// All members may be called in the cycle.
template <typename Vector>
class PassivityObserver {
 public:
  /// max_damping: most that damping() returns, N s/m or N m s/rad.
  PassivityObserver(int size, double max_damping)
      : max_damping_(max_damping), x_(Vector::Zero(size)), f_(x_) {}

  /// The next sample is the first. E_0: what the controller has in store, such as a stretched
  /// spring's energy, which it may give away.
  void reset(double E_0 = 0.0) noexcept {
    started_ = false;
    E_ = E_0;
  }
  void set_max_damping(double max_damping) noexcept { max_damping_ = max_damping; }

  /// The robot is at x now. Returns E, J. A sample that is not finite is left out: its step is
  /// counted with the next one.
  double observe(const Vector& x) noexcept {
    if (!x.allFinite()) return E_;
    if (started_) E_ -= f_.dot(x - x_);
    x_ = x;
    return E_;
  }

  /// The damping D for which the force -D v takes back a negative E within T seconds at the
  /// velocity v: -E / (T v . v), limited.
  double damping(const Vector& v, double T) const noexcept {
    if (!(E_ < 0.0)) return 0.0;
    const double needed = -E_ / std::max(T * v.squaredNorm(), std::numeric_limits<double>::min());
    return needed < max_damping_ ? needed : max_damping_;
  }

  /// The force that is held from now on, the damping included.
  void hold(const Vector& f) noexcept {
    if (!f.allFinite()) return;
    f_ = f;
    started_ = true;
  }

  /// False until a force is held.
  bool started() const noexcept { return started_; }
  double energy_J() const noexcept { return E_; }

 private:
  double max_damping_;
  Vector x_;
  Vector f_;
  double E_ = 0.0;
  bool started_ = false;
};

}  // namespace limber::controller
