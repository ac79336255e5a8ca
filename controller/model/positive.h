// Set-up check of a parameter that must be a positive number.
#pragma once

#include <cmath>
#include <string>

#include "common/config_error.h"

#pragma GCC visibility push(default)
namespace limber::controller {

/// `value` if it is finite and above zero; throws ConfigError with `name` otherwise. Not for the
/// cycle.
inline double positive(double value, const char* name) {
  if (!(value > 0.0 && std::isfinite(value))) {
    throw ConfigError(std::string(name) + " is " + std::to_string(value) +
                      "; it must be a finite number above 0");
  }
  return value;
}

}  // namespace limber::controller
#pragma GCC visibility pop
