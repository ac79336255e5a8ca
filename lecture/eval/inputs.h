// Typed access to a JSON object that somebody wrote: every key, shape and number is checked.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <utility>
#include <vector>

#include "common/types.h"
#include "lecture/eval/json.h"

namespace limber::eval {

/// How a joint quantity was written: as a list of numbers, or as one bare number.
struct Shape {
  int size = 1;
  bool scalar = false;

  /// A joint quantity written the same way.
  Json value(const VectorJ& joints) const { return scalar ? Json(joints[0]) : list_of(joints); }
};

/// The inputs of one case. Members without a fallback want the key; all throw ConfigError naming
/// the key, what is expected and what was found. `finish()` refuses what nobody asked for.
class Inputs {
 public:
  explicit Inputs(const Json& object);

  bool has(const std::string& key);
  std::string text(const std::string& key);
  const Json& object(const std::string& key);
  bool flag(const std::string& key, bool fallback);

  double number(const std::string& key);
  double positive(const std::string& key);
  double not_negative(const std::string& key);

  /// `size` numbers; zero where the second form finds no key.
  Eigen::VectorXd vector(const std::string& key, Eigen::Index size);
  Eigen::VectorXd vector_or_zero(const std::string& key, Eigen::Index size);
  /// `size` rows of as many numbers, symmetric, or `size` numbers for a diagonal matrix.
  Eigen::MatrixXd symmetric(const std::string& key, Eigen::Index size);
  Eigen::MatrixXd positive_definite(const std::string& key, Eigen::Index size);
  Eigen::MatrixXd positive_semidefinite(const std::string& key, Eigen::Index size);
  /// Rows of a rotation matrix.
  Eigen::Quaterniond rotation(const std::string& key);

  /// n rows of n numbers, or n numbers for a diagonal, or one number for all joints.
  MatrixJ joint_matrix(const std::string& key, Eigen::Index n);
  MatrixJ symmetric_joint_matrix(const std::string& key, Eigen::Index n);
  MatrixJ positive_definite_joint_matrix(const std::string& key, Eigen::Index n);
  /// The same where nothing but a diagonal makes sense.
  VectorJ joint_diagonal(const std::string& key, Eigen::Index n);
  VectorJ positive_diagonal(const std::string& key, Eigen::Index n);
  VectorJ not_negative_diagonal(const std::string& key, Eigen::Index n);

  /// How `key` is written, of 1 to 16 joints.
  Shape shape(const std::string& key);
  /// The same of the samples in the list `key`.
  Shape sample_shape(const std::string& key);
  VectorJ joints(const std::string& key, const Shape& shape);
  /// A list, not empty, of samples of one shape.
  std::vector<VectorJ> samples(const std::string& key, const Shape& shape);
  std::vector<VectorJ> samples(const std::string& key, const Shape& shape, std::size_t count);
  /// A list of `count` joint matrices.
  std::vector<MatrixJ> matrix_samples(const std::string& key, const Shape& shape,
                                      std::size_t count);

  /// The value that goes with one of the words.
  template <typename T>
  T choice(const std::string& key, const std::vector<std::pair<std::string, T>>& words) {
    std::vector<std::string> known;
    for (const auto& [word, value] : words) known.push_back(word);
    return words[choose(key, known)].second;
  }
  template <typename T>
  T choice(const std::string& key, const std::vector<std::pair<std::string, T>>& words,
           T fallback) {
    return has(key) ? choice(key, words) : fallback;
  }

  void finish() const;

 private:
  const Json& at(const std::string& key);
  std::size_t choose(const std::string& key, const std::vector<std::string>& words);

  const Json& object_;
  std::vector<std::string> asked_;
};

}  // namespace limber::eval
