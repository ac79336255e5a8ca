#include "lecture/eval/inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "common/config_error.h"
#include "common/suggest.h"
#include "lecture/eval/shapes.h"

namespace limber::eval {

Inputs::Inputs(const Json& object) : object_(object) {
  if (!object.is_object()) throw ConfigError("expected an object, found " + describe(object));
}

bool Inputs::has(const std::string& key) {
  if (std::find(asked_.begin(), asked_.end(), key) == asked_.end()) asked_.push_back(key);
  return object_.contains(key);
}

const Json& Inputs::at(const std::string& key) {
  if (has(key)) return object_.at(key);
  std::vector<std::string> given;
  for (const auto& item : object_.items()) given.push_back(item.key());
  throw ConfigError(key + " is missing; given: " + (given.empty() ? "nothing" : joined(given)));
}

std::string Inputs::text(const std::string& key) {
  const Json& value = at(key);
  if (!value.is_string()) refuse(key, "text", value);
  return value.get<std::string>();
}

const Json& Inputs::object(const std::string& key) {
  const Json& value = at(key);
  if (!value.is_object()) refuse(key, "an object", value);
  return value;
}

bool Inputs::flag(const std::string& key, bool fallback) {
  if (!has(key)) return fallback;
  const Json& value = at(key);
  if (!value.is_boolean() && value != 0 && value != 1) refuse(key, "true or false", value);
  return value.is_boolean() ? value.get<bool>() : value == 1;
}

double Inputs::number(const std::string& key) { return read_number(key, at(key)); }

double Inputs::positive(const std::string& key) {
  const double value = number(key);
  if (!(value > 0.0)) refuse(key, "a number above 0", at(key));
  return value;
}

double Inputs::not_negative(const std::string& key) {
  const double value = number(key);
  if (!(value >= 0.0)) refuse(key, "a number from 0 on", at(key));
  return value;
}

std::size_t Inputs::choose(const std::string& key, const std::vector<std::string>& words) {
  const std::string word = text(key);
  const auto found = std::find(words.begin(), words.end(), word);
  if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
  const std::string near = nearest_word(word, words);
  throw ConfigError(fmt::format("{}: '{}' is none of {}{}", key, word, joined(words),
                                near.empty() ? "" : "; did you mean '" + near + "'?"));
}

void Inputs::finish() const {
  std::vector<std::string> open;
  std::copy_if(asked_.begin(), asked_.end(), std::back_inserter(open),
               [this](const std::string& key) { return !object_.contains(key); });
  for (const auto& item : object_.items()) {
    const std::string& key = item.key();
    if (std::find(asked_.begin(), asked_.end(), key) != asked_.end()) continue;
    const std::string near = nearest_word(key, open);
    throw ConfigError(fmt::format("{} is no input here{}; there are: {}", key,
                                  near.empty() ? "" : ", did you mean '" + near + "'?",
                                  joined(asked_)));
  }
}

}  // namespace limber::eval
