#include "controller/gains/read_gains.h"

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

}  // namespace

Gains default_gains(const Robot& robot, LawRows rows) {
  Gains gains(robot.size(), rows);
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
  const LawRows rows = parameters->rows();
  if (request.scope == compliance_gains_t::SCOPE_ALL) *parameters = LawParameters(joints, rows);
  for (const law_parameter_t& given : request.parameters) {
    const GainRow* row = find_row(rows, given.key);
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
