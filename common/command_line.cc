#include "common/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <utility>

#include "common/config_error.h"

namespace limber {
namespace {

/// CLI11's own ranges let NaN pass.
CLI::Validator number_from(double low, double high) {
  return CLI::Validator(
      [low, high](const std::string& text) {
        double value = 0.0;
        const bool number = CLI::detail::lexical_cast(text, value);
        if (number && value >= low && value <= high) return std::string();
        return fmt::format("{} is not a number from {:g} to {:g}", text, low, high);
      },
      "");
}

template <typename Value>
CLI::Option* with_default(CLI::Option* option, const Value& value) {
  return value == Value() ? option : option->capture_default_str();
}

void read_address(const std::string& text, std::map<std::string, std::string>* addresses) {
  const auto equals = text.find('=');
  if (equals == 0 || equals == std::string::npos)
    throw CLI::ValidationError("--bus " + text, "write NAME=ADDRESS, as in can0=virtual:arm");
  (*addresses)[text.substr(0, equals)] = text.substr(equals + 1);
}

}  // namespace

Option Option::required() {
  option_->required();
  return *this;
}
Option Option::needs(Option other) {
  option_->needs(other.option_);
  return *this;
}
Option Option::excludes(Option other) {
  option_->excludes(other.option_);
  return *this;
}
Option Option::one_of(std::vector<std::string> words) {
  option_->check(CLI::IsMember(std::move(words)));
  return *this;
}

Option Option::count(int values) {
  option_->expected(values);
  return *this;
}

CommandLine::CommandLine(std::string name, const std::string& purpose)
    : name_(std::move(name)),
      owned_(std::make_unique<CLI::App>(purpose, name_)),
      app_(owned_.get()) {}

CommandLine::CommandLine(std::string name, CLI::App* command)
    : name_(std::move(name)), app_(command) {}

CommandLine::~CommandLine() = default;

Option CommandLine::flag(const std::string& names, bool* value, const std::string& help) {
  return Option(app_->add_flag(names, *value, help));
}

Option CommandLine::text(const std::string& names, std::string* value, const std::string& help) {
  return Option(with_default(app_->add_option(names, *value, help), *value));
}

Option CommandLine::texts(const std::string& names, std::vector<std::string>* value,
                          const std::string& help) {
  return Option(app_->add_option(names, *value, help));
}

Option CommandLine::number(const std::string& names, double* value, double low, double high,
                           const std::string& help) {
  auto* option = app_->add_option(names, *value, help)->check(number_from(low, high));
  return Option(with_default(option, *value));
}

Option CommandLine::integer(const std::string& names, std::int64_t* value, std::int64_t low,
                            std::int64_t high, const std::string& help) {
  auto* option = app_->add_option(names, *value, help)->check(CLI::Range(low, high));
  return Option(with_default(option, *value));
}

Option CommandLine::numbers(const std::string& names, std::vector<double>* value,
                            const std::string& help) {
  return Option(app_->add_option(names, *value, help)->delimiter(','));
}

Option CommandLine::integers(const std::string& names, std::vector<std::int64_t>* value,
                             const std::string& help) {
  return Option(app_->add_option(names, *value, help)->delimiter(','));
}

CommandLine& CommandLine::command(const std::string& name, const std::string& purpose) {
  app_->require_subcommand(1);
  commands_.emplace_back(new CommandLine(name, app_->add_subcommand(name, purpose)));
  return *commands_.back();
}

void CommandLine::when_chosen(const std::function<void()>& chosen) {
  app_->parse_complete_callback(chosen);
}

Option CommandLine::buses(std::map<std::string, std::string>* addresses) {
  const auto read = [addresses](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) read_address(text, addresses);
    return true;
  };
  return Option(
      app_->add_option(
              "--bus", CLI::callback_t(read),
              "NAME=ADDRESS, such as arm=socketcan:can0: another address for a bus of robot.yaml")
          ->expected(1, CLI::detail::expected_max_vector_size));
}

void CommandLine::pace(std::optional<Pace>* pace, const std::string& meaning_of_lockstep) {
  const auto set = [pace](Pace value) { return [pace, value](std::int64_t) { *pace = value; }; };
  auto* steps = app_->add_flag_function("--lockstep", set(Pace::kLockstep), meaning_of_lockstep);
  auto* paced =
      app_->add_flag_function("--paced", set(Pace::kPaced), "lock step, not faster than the clock");
  auto* clock = app_->add_flag_function("--realtime", set(Pace::kRealtime), "run by the clock");
  clock->excludes(steps);
  paced->excludes(steps)->excludes(clock);
}

Option CommandLine::priority(int* value) {
  return Option(app_->add_option("--realtime-priority", *value,
                                 "SCHED_FIFO priority in realtime; 0: normal scheduling")
                    ->check(CLI::Range(0, 99))
                    ->capture_default_str());
}

bool CommandLine::parse(int argc, char** argv) {
  try {
    app_->parse(argc, argv);
  } catch (const CLI::Success& help) {
    app_->exit(help);
    return false;
  } catch (const CLI::ParseError& error) {
    throw ConfigError(error.what());
  }
  return true;
}

}  // namespace limber
