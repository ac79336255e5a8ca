#include "dynamics/levels.h"

#include <fmt/format.h>

#include <cstdlib>
#include <string>

#include "common/config_error.h"
#include "dynamics/geometric_mean.h"
#include "dynamics/spd_solve.h"

namespace limber::dynamics {

namespace plain {
extern const Level kLevel;
}
#ifdef __x86_64__
namespace avx2 {
extern const Level kLevel;
}
namespace avx512 {
extern const Level kLevel;
}
#endif

std::vector<const Level*> levels() {
  std::vector<const Level*> here;
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx512f")) here.push_back(&avx512::kLevel);
  if (__builtin_cpu_supports("avx2")) here.push_back(&avx2::kLevel);
#endif
  here.push_back(&plain::kLevel);
  return here;
}

const Level& named_level(std::string_view name) {
  std::string names;
  for (const Level* level : levels()) {
    if (level->name == name) return *level;
    names += std::string(names.empty() ? "" : ", ") + level->name;
  }
  throw ConfigError(fmt::format("LIMBER_PROCESSOR is '{}'; this processor runs {}", name, names));
}

const Level& level() {
  static const Level& chosen = [name = std::getenv("LIMBER_PROCESSOR")]() -> const Level& {
    return name == nullptr ? *levels().front() : named_level(name);
  }();
  return chosen;
}

AnyArmKernel arm_kernel(const BodyChain& chain, const Eigen::Vector3d& gravity) {
  return AnyArmKernel(level().arm_kernel(chain, gravity));
}

void solve_spd(const MatrixJ& M, VectorJ* X) noexcept { level().solve_one(M, X); }

void solve_spd(const MatrixJ& M, const Matrix6J& J, MatrixJ6* Minv_JT, Matrix6* G) noexcept {
  level().solve_tip(M, J, Minv_JT, G);
}

Matrix6 inverse_spd(const Matrix6& G) noexcept { return level().inverse(G); }

bool geometric_mean(const Eigen::Ref<const Eigen::MatrixXd>& P,
                    const Eigen::Ref<const Eigen::MatrixXd>& Q,
                    Eigen::Ref<Eigen::MatrixXd> G) noexcept {
  return level().mean(P, Q, G);
}

}  // namespace limber::dynamics
