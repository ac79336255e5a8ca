// Reads numbers, vectors and matrices from JSON values. Everything throws ConfigError naming
// `where`, what is expected and what was found.
#pragma once

#include <string>

#include "lecture/eval/json.h"

namespace limber::eval {

/// "7", "'text'", "a list of 3", "2 rows of 3", ...
std::string describe(const Json& value);

[[noreturn]] void refuse(const std::string& where, const std::string& expected, const Json& found);

double read_number(const std::string& where, const Json& value);
Eigen::VectorXd read_vector(const std::string& where, const Json& value, Eigen::Index size);
/// `size` rows of `size` numbers, or `size` numbers for a diagonal.
Eigen::MatrixXd read_square(const std::string& where, const Json& value, Eigen::Index size);

}  // namespace limber::eval
