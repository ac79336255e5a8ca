// The vectors and matrices of a case.
#include <fmt/format.h>

#include <Eigen/Eigenvalues>

#include "common/config_error.h"
#include "common/joints.h"
#include "lecture/eval/inputs.h"
#include "lecture/eval/shapes.h"

namespace limber::eval {
namespace {

// Rotation matrices are often written with few digits.
constexpr double kNotRotation = 1e-6;
constexpr double kNotSymmetric = 1e-9;

Shape shape_of(const std::string& where, const Json& value) {
  if (value.is_number()) return {1, true};
  if (!value.is_array() || value.empty() || value.size() > kMaxJoints)
    refuse(where, fmt::format("a number, or 1 to {} numbers", kMaxJoints), value);
  return {static_cast<int>(value.size()), false};
}

VectorJ read_joints(const std::string& where, const Json& value, const Shape& shape) {
  if (shape.scalar && value.is_number()) return VectorJ::Constant(1, read_number(where, value));
  return read_vector(where, value, shape.size);
}

void check_symmetric(const std::string& key, const Eigen::MatrixXd& matrix) {
  const double largest = matrix.cwiseAbs().maxCoeff();
  Eigen::Index i = 0;
  Eigen::Index k = 0;
  const double off = (matrix - matrix.transpose()).cwiseAbs().maxCoeff(&i, &k);
  if (off <= kNotSymmetric * largest) return;
  throw ConfigError(
      fmt::format("{}: expected a symmetric matrix, found [{}][{}] = {} but [{}][{}] "
                  "= {}",
                  key, i, k, matrix(i, k), k, i, matrix(k, i)));
}

// `share`: least eigenvalue allowed, as a share of the greatest entry.
void check_definite(const std::string& key, const Eigen::MatrixXd& matrix, double share) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(matrix, Eigen::EigenvaluesOnly);
  const double least = eigen.eigenvalues()[0];
  if (least > share * matrix.cwiseAbs().maxCoeff()) return;
  throw ConfigError(
      fmt::format("{}: expected a positive {}definite matrix, found one with the "
                  "eigenvalue {:.6g}",
                  key, share < 0.0 ? "semi" : "", least));
}

MatrixJ read_joint_matrix(const std::string& where, const Json& value, Eigen::Index n) {
  if (value.is_number()) return read_number(where, value) * MatrixJ::Identity(n, n);
  return read_square(where, value, n);
}

}  // namespace

Eigen::VectorXd Inputs::vector(const std::string& key, Eigen::Index size) {
  return read_vector(key, at(key), size);
}

Eigen::VectorXd Inputs::vector_or_zero(const std::string& key, Eigen::Index size) {
  return has(key) ? vector(key, size) : Eigen::VectorXd(Eigen::VectorXd::Zero(size));
}

Eigen::MatrixXd Inputs::symmetric(const std::string& key, Eigen::Index size) {
  const Eigen::MatrixXd matrix = read_square(key, at(key), size);
  check_symmetric(key, matrix);
  return matrix;
}

Eigen::MatrixXd Inputs::positive_definite(const std::string& key, Eigen::Index size) {
  const Eigen::MatrixXd matrix = symmetric(key, size);
  check_definite(key, matrix, 0.0);
  return matrix;
}

Eigen::MatrixXd Inputs::positive_semidefinite(const std::string& key, Eigen::Index size) {
  const Eigen::MatrixXd matrix = symmetric(key, size);
  if (!matrix.isZero(0.0)) check_definite(key, matrix, -kNotSymmetric);
  return matrix;
}

Eigen::Quaterniond Inputs::rotation(const std::string& key) {
  const Json& value = at(key);
  if (!value.is_array() || value.size() != 3 || !value.front().is_array())
    refuse(key, "3 rows of 3 numbers", value);
  const Eigen::Matrix3d R = read_square(key, value, 3);
  const double off = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(off <= kNotRotation && R.determinant() > 0.0)) {
    throw ConfigError(
        fmt::format("{}: expected a rotation matrix, found one with |R R^T - I| = "
                    "{:.3g} and determinant {:.3g}",
                    key, off, R.determinant()));
  }
  return Eigen::Quaterniond(R).normalized();
}

MatrixJ Inputs::joint_matrix(const std::string& key, Eigen::Index n) {
  return read_joint_matrix(key, at(key), n);
}

MatrixJ Inputs::symmetric_joint_matrix(const std::string& key, Eigen::Index n) {
  const MatrixJ matrix = joint_matrix(key, n);
  check_symmetric(key, matrix);
  return matrix;
}

MatrixJ Inputs::positive_definite_joint_matrix(const std::string& key, Eigen::Index n) {
  const MatrixJ matrix = symmetric_joint_matrix(key, n);
  check_definite(key, matrix, 0.0);
  return matrix;
}

VectorJ Inputs::joint_diagonal(const std::string& key, Eigen::Index n) {
  const MatrixJ matrix = joint_matrix(key, n);
  if (!matrix.isDiagonal(0.0)) refuse(key, "a diagonal matrix", at(key));
  return matrix.diagonal();
}

VectorJ Inputs::positive_diagonal(const std::string& key, Eigen::Index n) {
  const VectorJ diagonal = joint_diagonal(key, n);
  if (!(diagonal.minCoeff() > 0.0)) refuse(key, "numbers above 0", at(key));
  return diagonal;
}

VectorJ Inputs::not_negative_diagonal(const std::string& key, Eigen::Index n) {
  const VectorJ diagonal = joint_diagonal(key, n);
  if (!(diagonal.minCoeff() >= 0.0)) refuse(key, "numbers from 0 on", at(key));
  return diagonal;
}

Shape Inputs::shape(const std::string& key) { return shape_of(key, at(key)); }

Shape Inputs::sample_shape(const std::string& key) {
  const Json& list = at(key);
  if (!list.is_array() || list.empty()) refuse(key, "a list of samples", list);
  return shape_of(key + "[0]", list.front());
}

VectorJ Inputs::joints(const std::string& key, const Shape& shape) {
  return read_joints(key, at(key), shape);
}

std::vector<VectorJ> Inputs::samples(const std::string& key, const Shape& shape) {
  const Json& list = at(key);
  if (!list.is_array() || list.empty()) refuse(key, "a list of samples", list);
  std::vector<VectorJ> samples;
  for (std::size_t i = 0; i < list.size(); ++i)
    samples.push_back(read_joints(fmt::format("{}[{}]", key, i), list[i], shape));
  return samples;
}

std::vector<VectorJ> Inputs::samples(const std::string& key, const Shape& shape,
                                     std::size_t count) {
  std::vector<VectorJ> list = samples(key, shape);
  if (list.size() != count) refuse(key, fmt::format("a list of {} samples", count), at(key));
  return list;
}

std::vector<MatrixJ> Inputs::matrix_samples(const std::string& key, const Shape& shape,
                                            std::size_t count) {
  const Json& list = at(key);
  if (!list.is_array() || list.size() != count)
    refuse(key, fmt::format("a list of {} samples", count), list);
  std::vector<MatrixJ> samples;
  for (std::size_t i = 0; i < count; ++i)
    samples.push_back(read_joint_matrix(fmt::format("{}[{}]", key, i), list[i], shape.size));
  return samples;
}

}  // namespace limber::eval
