// Numbers, vectors and matrices as JSON: lists, and lists of rows.
#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>

namespace limber::eval {

/// Keeps the order in which keys were written.
using Json = nlohmann::ordered_json;

template <typename Derived>
Json list_of(const Eigen::MatrixBase<Derived>& vector) {
  Json list = Json::array();
  for (Eigen::Index i = 0; i < vector.size(); ++i) list.push_back(double{vector[i]});
  return list;
}

template <typename Derived>
Json rows_of(const Eigen::MatrixBase<Derived>& matrix) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) rows.push_back(list_of(matrix.row(i)));
  return rows;
}

}  // namespace limber::eval
