// Options of a program. A narrow front of CLI11, which is compiled here once and not in every
// program.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/pace.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace limber {

/// What an option depends on. Set-up only, as all of this file.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}
  Option required();
  Option needs(Option other);
  Option excludes(Option other);
  Option one_of(std::vector<std::string> words);
  /// Exactly so many values.
  Option count(int values);

 private:
  CLI::Option* option_;
};

/// Each member declares one option: its names as in CLI11 ("--log", "file" for a position), where
/// its value goes, the help text. A default that is neither empty nor 0 is shown in the help.
class CommandLine {
 public:
  /// `name` of the program, such as limber-lab; `purpose` in a sentence.
  CommandLine(std::string name, const std::string& purpose);
  ~CommandLine();

  Option flag(const std::string& names, bool* value, const std::string& help);
  Option text(const std::string& names, std::string* value, const std::string& help);
  Option texts(const std::string& names, std::vector<std::string>* value, const std::string& help);
  /// Numbers outside low..high, NaN among them, are refused.
  Option number(const std::string& names, double* value, double low, double high,
                const std::string& help);
  Option integer(const std::string& names, std::int64_t* value, std::int64_t low, std::int64_t high,
                 const std::string& help);
  /// x,y,z
  Option numbers(const std::string& names, std::vector<double>* value, const std::string& help);
  /// 1,2,3
  Option integers(const std::string& names, std::vector<std::int64_t>* value,
                  const std::string& help);
  /// A command with options of its own; exactly one of the commands must be given.
  CommandLine& command(const std::string& name, const std::string& purpose);
  /// Calls `chosen` during parse() if this command is the one that was given.
  void when_chosen(const std::function<void()>& chosen);

  // What several programs have in common.

  /// --bus NAME=ADDRESS, any number of times.
  Option buses(std::map<std::string, std::string>* addresses);
  /// --lockstep, --paced or --realtime; none leaves the value empty.
  void pace(std::optional<Pace>* pace, const std::string& meaning_of_lockstep);
  /// --realtime-priority
  Option priority(int* value);

  const std::string& name() const { return name_; }
  /// Fills in all values. False if there is nothing more to do, because help was asked for and
  /// printed. Throws ConfigError if an argument is wrong.
  bool parse(int argc, char** argv);

 private:
  CommandLine(std::string name, CLI::App* command);

  std::string name_;
  std::unique_ptr<CLI::App> owned_;
  CLI::App* app_;
  std::vector<std::unique_ptr<CommandLine>> commands_;
};

}  // namespace limber
