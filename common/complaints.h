// Collects what is wrong with a file, so that a user sees all of it at once.
#pragma once

#include <string>
#include <vector>

#include "common/config_error.h"

namespace limber {

class Complaints {
 public:
  explicit Complaints(std::string file) : file_(std::move(file)) {}

  /// "file:line: where: problem". The first 50 are kept.
  void add(int line, const std::string& where, const std::string& problem);

  /// Runs one independent part of the reading; what it throws becomes a complaint. False if it did.
  template <typename Part>
  bool collect(Part part) {
    try {
      part();
      return true;
    } catch (const ConfigError& error) {
      add(error.what());
      return false;
    }
  }

  bool any() const { return !lines_.empty(); }
  const std::vector<std::string>& lines() const { return lines_; }
  /// Throws ConfigError with one complaint a line, if there are any.
  void throw_if_any() const;

 private:
  void add(const std::string& complaint);

  std::string file_;
  std::vector<std::string> lines_;
};

}  // namespace limber
