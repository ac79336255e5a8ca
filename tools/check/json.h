// Just enough to write JSON.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace limber::json {

/// Keys with values that are JSON text already.
using Members = std::vector<std::pair<std::string, std::string>>;

/// Each returns JSON text. Numbers that are not finite become null.
std::string text(const std::string& value);
std::string flag(bool value);
std::string number(double value);
std::string numbers(const std::vector<double>& values);
std::string texts(const std::vector<std::string>& values);
/// Of values that are JSON text already.
std::string list(const std::vector<std::string>& values);
std::string object(const Members& members);

}  // namespace limber::json
