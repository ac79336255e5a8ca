#include "lecture/eval/evaluate.h"

#include <fmt/format.h>

#include <cmath>
#include <set>
#include <vector>

#include "common/config_error.h"
#include "lecture/eval/law_table.h"
#include "lecture/eval/shapes.h"

namespace limber::eval {
namespace {

// JSON has no number for what is not finite; the library would write null.
void check_finite(const std::string& where, const Json& value) {
  if (value.is_number_float() && !std::isfinite(value.get<double>())) {
    throw ConfigError("the output " + where +
                      " is not finite: the law is not defined for these inputs");
  }
  if (!value.is_structured()) return;
  for (const Json& part : value) check_finite(where, part);
}

Json outputs(const LawRow& law, const Json* robot, Inputs& in, Arms* arms) {
  Json out = law.alone != nullptr ? law.alone(in) : law.with_arm(arms->find(robot), in);
  in.finish();
  for (const auto& item : out.items()) check_finite(item.key(), item.value());
  return out;
}

Json evaluate_case(const Json& given, Arms* arms) {
  Inputs parts(given);
  const std::string name = parts.text("law");
  const bool names_arm = parts.has("robot") && !given.at("robot").is_null();
  const Json& in = parts.object("in");
  parts.finish();
  const LawRow& law = find_law_row(name);
  try {
    Inputs inputs(in);
    return outputs(law, names_arm ? &given.at("robot") : nullptr, inputs, arms);
  } catch (const ConfigError& error) {
    throw ConfigError(fmt::format("law {}: {}", name, error.what()));
  }
}

}  // namespace

Json parse(const std::string& text) {
  std::vector<std::set<std::string>> keys;
  const auto watch = [&keys](int, Json::parse_event_t event, Json& value) {
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key && !keys.back().insert(value.get<std::string>()).second)
      throw ConfigError("the key \"" + value.get<std::string>() + "\" is given twice");
    return true;
  };
  try {
    return Json::parse(text, watch);
  } catch (const Json::exception& error) {
    const std::string what = error.what();
    throw ConfigError("this is no JSON: " + what.substr(what.find("] ") + 2));
  }
}

Json evaluate(const Json& document, Arms* arms) {
  if (!document.is_array()) return evaluate_case(document, arms);
  Json list = Json::array();
  for (std::size_t i = 0; i < document.size(); ++i) {
    try {
      list.push_back(evaluate_case(document[i], arms));
    } catch (const ConfigError& error) {
      throw ConfigError(fmt::format("case {} of {}: {}", i + 1, document.size(), error.what()));
    }
  }
  return list;
}

}  // namespace limber::eval
