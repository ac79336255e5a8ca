#include "controller/goals/stream/derivative_weights.h"

namespace limber::controller {

// The derivatives at zero of the Lagrange polynomials, from those through one time less.
DerivativeWeights derivative_weights(std::span<const double> times) noexcept {
  DerivativeWeights w;
  std::array<double, 5> value{1.0};
  double before = 1.0;
  for (std::size_t n = 1; n < times.size(); ++n) {
    double product = 1.0;
    const double last = times[n - 1];
    const std::array<double, 3> tail{value[n - 1], w.first[n - 1], w.second[n - 1]};
    for (std::size_t k = 0; k < n; ++k) {
      const double apart = times[n] - times[k];
      product *= apart;
      w.second[k] = (times[n] * w.second[k] - 2.0 * w.first[k]) / apart;
      w.first[k] = (times[n] * w.first[k] - value[k]) / apart;
      value[k] = times[n] * value[k] / apart;
    }
    const double ratio = before / product;
    w.second[n] = ratio * (2.0 * tail[1] - last * tail[2]);
    w.first[n] = ratio * (tail[0] - last * tail[1]);
    value[n] = -ratio * last * tail[0];
    before = product;
  }
  return w;
}

}  // namespace limber::controller
