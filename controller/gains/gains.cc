#include "controller/gains/gains.h"

#include "controller/laws/registry.h"
#include "robots/loader/default_gains.h"

namespace limber::controller {
namespace {

using RowMajor6f = Eigen::Matrix<float, 6, 6, Eigen::RowMajor>;
using RowMajor6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

Matrix6 matrix(const double (&m)[6][6]) noexcept { return Eigen::Map<const RowMajor6>(&m[0][0]); }
Matrix6 matrix(const float (&m)[6][6]) noexcept {
  return Eigen::Map<const RowMajor6f>(&m[0][0]).cast<double>();
}

Matrix6 symmetric(const Matrix6& M) noexcept { return 0.5 * (M + M.transpose()); }

template <typename T>
MatrixJ diagonal(const T* values, Eigen::Index n) noexcept {
  MatrixJ M = MatrixJ::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) M(i, i) = static_cast<double>(values[i]);
  return M;
}

LawSettings read_settings(const compliance_gains_t& message) noexcept {
  LawSettings s;
  s.position_feedback = static_cast<PositionFeedback>(message.position_feedback);
  s.orientation = static_cast<Orientation>(message.orientation);
  s.frame = static_cast<GainFrame>(message.frame);
  s.model_compensation = static_cast<ModelCompensation>(message.model_compensation);
  s.damping = static_cast<DampingDesign>(message.damping);
  s.joint_damping = static_cast<DampingDesign>(message.joint_damping);
  s.stiffness_terms = static_cast<StiffnessTerms>(message.stiffness_terms);
  s.projector = static_cast<Projector>(message.projector);
  s.contact = static_cast<ContactSource>(message.contact);
  s.velocity = static_cast<VelocitySource>(message.velocity);
  s.friction_compensation = static_cast<FrictionCompensation>(message.friction_compensation);
  s.friction_share = static_cast<double>(message.friction_share);
  s.velocity_cutoff_rad_per_s = static_cast<double>(message.velocity_cutoff_rad_per_s);
  s.velocity_acceleration_rad_per_s2 =
      static_cast<double>(message.velocity_acceleration_rad_per_s2);
  s.acceleration_filter_s = message.acceleration_filter_s;
  s.observer_gain_per_s = static_cast<double>(message.observer_gain_per_s);
  s.friction_observer_gain_per_s = static_cast<double>(message.friction_observer_gain_per_s);
  s.tank_J = static_cast<double>(message.tank_J);
  s.passivity_damping_Ns_per_m = static_cast<double>(message.passivity_damping_Ns_per_m);
  s.spring_force_N = static_cast<double>(message.spring_force_N);
  s.spring_moment_Nm = static_cast<double>(message.spring_moment_Nm);
  for (std::size_t i = 0; i < kTerms; ++i) s.period_cycles[i] = message.period_cycles[i];
  return s;
}

}  // namespace

Gains::Gains(int joints)
    : K_q(MatrixJ::Zero(joints, joints)),
      D_q(K_q),
      K_null(K_q),
      D_null(K_q),
      settings(default_settings()),
      parameters(joints) {}

const LawSettings& default_settings() noexcept {
  static const LawSettings settings = read_settings(standard_gains());
  return settings;
}

Gains default_gains(const Robot& robot) {
  Gains gains(robot.size());
  read_gains(limber::default_gains(robot), &gains);
  return gains;
}

void read_gains(const compliance_gains_t& message, Gains* gains) noexcept {
  const Eigen::Index n = gains->K_q.rows();
  gains->settings = read_settings(message);
  gains->K_x = symmetric(matrix(message.K_x));
  gains->damping_ratio = message.damping_ratio;
  gains->D_x = symmetric(matrix(message.D_x));
  gains->M_x = symmetric(matrix(message.M_x));
  gains->K_q = diagonal(message.K_q, n);
  gains->joint_damping_ratio = message.joint_damping_ratio;
  gains->D_q = diagonal(message.D_q, n);
  gains->K_null = diagonal(message.K_null, n);
  gains->D_null = diagonal(message.D_null, n);
}

void read_parameters(const compliance_gains_t& request, LawParameters* parameters,
                     int joints) noexcept {
  if (request.scope == compliance_gains_t::SCOPE_ALL) *parameters = LawParameters(joints);
  for (const law_parameter_t& given : request.parameters) {
    const GainRow* row = find_row(law_catalog().parameters, given.key);
    if (row->per_joint) {
      parameters->set(*row, diagonal(given.values.data(), joints));
    } else {
      parameters->set(*row, static_cast<double>(given.values.front()));
    }
  }
}

void turn_to_base(const Eigen::Matrix3d& R_BD, Gains* gains) noexcept {
  if (gains->settings.frame == GainFrame::kBase) return;
  Matrix6 T = Matrix6::Zero();
  T.topLeftCorner<3, 3>() = T.bottomRightCorner<3, 3>() = R_BD;
  for (Matrix6* M : {&gains->K_x, &gains->D_x, &gains->M_x}) {
    *M = symmetric(T * *M * T.transpose());
  }
}

}  // namespace limber::controller
