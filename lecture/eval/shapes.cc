#include "lecture/eval/shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/config_error.h"

namespace limber::eval {
namespace {

constexpr std::size_t kLongestText = 40;

std::string describe_list(const Json& list) {
  if (list.empty()) return "an empty list";
  const bool rows = list.front().is_array();
  std::size_t shortest = rows ? list.front().size() : 0;
  std::size_t longest = shortest;
  for (const Json& row : list) {
    if (row.is_array() != rows) return "a list in which some entries are lists and others are not";
    if (!rows) continue;
    shortest = std::min(shortest, row.size());
    longest = std::max(longest, row.size());
  }
  if (!rows) return fmt::format("a list of {}", list.size());
  if (shortest == longest) return fmt::format("{} rows of {}", list.size(), longest);
  return fmt::format("{} rows of {} to {}", list.size(), shortest, longest);
}

}  // namespace

std::string describe(const Json& value) {
  if (value.is_array()) return describe_list(value);
  if (value.is_object()) return "an object";
  const std::string text = value.dump(-1, ' ', true);  // ASCII: may be cut anywhere
  if (text.size() <= kLongestText) return text;
  return fmt::format("{}...", text.substr(0, kLongestText));
}

void refuse(const std::string& where, const std::string& expected, const Json& found) {
  throw ConfigError(fmt::format("{}: expected {}, found {}", where, expected, describe(found)));
}

double read_number(const std::string& where, const Json& value) {
  if (!value.is_number()) refuse(where, "a number", value);
  const double number = value.get<double>();
  if (!std::isfinite(number)) refuse(where, "a finite number", value);
  return number;
}

Eigen::VectorXd read_vector(const std::string& where, const Json& value, Eigen::Index size) {
  const auto count = static_cast<std::size_t>(size);
  if (!value.is_array() || value.size() != count || value.front().is_array())
    refuse(where, fmt::format("{} number{}", size, size == 1 ? "" : "s"), value);
  Eigen::VectorXd vector(size);
  for (std::size_t i = 0; i < count; ++i)
    vector[static_cast<Eigen::Index>(i)] = read_number(fmt::format("{}[{}]", where, i), value[i]);
  return vector;
}

Eigen::MatrixXd read_square(const std::string& where, const Json& value, Eigen::Index size) {
  const auto count = static_cast<std::size_t>(size);
  const auto wrong = [&]() {
    refuse(where, fmt::format("{0} rows of {0} numbers (or {0} numbers for a diagonal)", size),
           value);
  };
  if (!value.is_array() || value.size() != count) wrong();
  if (!value.front().is_array()) return read_vector(where, value, size).asDiagonal();
  Eigen::MatrixXd matrix(size, size);
  for (std::size_t i = 0; i < count; ++i) {
    if (!value[i].is_array() || value[i].size() != count) wrong();
    matrix.row(static_cast<Eigen::Index>(i)) =
        read_vector(fmt::format("{}[{}]", where, i), value[i], size);
  }
  return matrix;
}

}  // namespace limber::eval
