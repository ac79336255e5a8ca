// Tests of what is refused: a good file, one change of its text, and what the complaint must say.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "common/config_error.h"

namespace limber::testing {

inline std::string read_text(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  EXPECT_TRUE(stream) << path;
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// A folder of its own that goes away with the object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "limber-XXXXXX").string();
    path_ = ::mkdtemp(pattern.data());
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name, std::ios::binary) << text;
    return path_ / name;
  }
  std::string path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Stands for "whatever line the complaint names, or none".
inline constexpr int kNoLine = -1000;

struct Mutation {
  std::string name;     ///< of the test
  std::string find;     ///< stands in the good file exactly once, or is its first occurrence
  std::string replace;  ///< what stands there instead
  std::string expect;   ///< part of the complaint
  int lines_off = 0;    ///< line of the complaint, counted from the line where `find` begins
};

inline std::ostream& operator<<(std::ostream& out, const Mutation& mutation) {
  return out << mutation.find << " -> " << mutation.replace;
}

struct Mutated {
  std::string text;
  int line = 0;  ///< that the complaint must name; 0: any
};

inline Mutated apply(const std::string& good, const Mutation& mutation) {
  const auto at = good.find(mutation.find);
  EXPECT_NE(at, std::string::npos) << "not in the good file: " << mutation.find;
  if (at == std::string::npos) return {};
  Mutated result;
  result.text = good;
  result.text.replace(at, mutation.find.size(), mutation.replace);
  if (mutation.lines_off != kNoLine) {
    result.line =
        1 + mutation.lines_off +
        static_cast<int>(std::count(good.begin(), good.begin() + static_cast<long>(at), '\n'));
  }
  return result;
}

/// What the call throws, which must be a ConfigError.
template <typename Call>
std::string complaint_of(Call call) {
  try {
    call();
  } catch (const ConfigError& error) {
    return error.what();
  }
  ADD_FAILURE() << "was not refused";
  return "";
}

/// The complaint names "file:line: " and says what is expected, in one and the same line.
inline void expect_complaint(const std::string& complaint, const std::string& file, int line,
                             const std::string& expect) {
  const std::string place = file + ":" + (line > 0 ? std::to_string(line) + ": " : "");
  std::istringstream lines(complaint);
  for (std::string one; std::getline(lines, one);) {
    if (one.find(place) != std::string::npos && one.find(expect) != std::string::npos) return;
  }
  ADD_FAILURE() << "expected \"" << place << "\" with \"" << expect << "\", got:\n" << complaint;
}

/// Name of a parameterised test.
struct MutationName {
  std::string operator()(const ::testing::TestParamInfo<Mutation>& info) const {
    return info.param.name;
  }
};

}  // namespace limber::testing
