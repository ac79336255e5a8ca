#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "tools/motors/dump.h"

namespace limber::motor_tools {
namespace {

using Use = Setting::Use;

struct Change {
  Setting setting;
  double wanted = 0.0;
  std::string text;  ///< of the file
};

struct Restored {
  Motor motor;
  YamlMap yaml;
  bool fd;
  std::size_t bus;  ///< index of its wire
  std::vector<Change> changes = {};
};

/// Numbers as the motor keeps them: in single precision, unless they are whole.
bool same(const std::string& a, const std::string& b, Format format) {
  if (a == b) return true;
  char *end_a = nullptr, *end_b = nullptr;
  const double x = std::strtod(a.c_str(), &end_a), y = std::strtod(b.c_str(), &end_b);
  if (*end_a != '\0' || *end_b != '\0') return false;
  const bool single = format == Format::kFloat || format == Format::kFloatOrNone;
  return x == y || (single && static_cast<float>(x) == static_cast<float>(y));
}

double number_of(const YamlMap& section, const Setting& setting) {
  const Range allowed = range_of(setting.format);
  if (setting.format == Format::kFloatOrNone && section.text(setting.name) == "nan")
    return std::nan("");
  if (setting.format == Format::kFloat || setting.format == Format::kFloatOrNone)
    return section.number(setting.name, allowed);
  return static_cast<double>(section.integer(setting.name, static_cast<long>(allowed.low),
                                             static_cast<long>(allowed.high)));
}

/// Prints how the motor differs from its section of the file; what is to be written.
std::vector<Change> differences(const Motor& motor, const YamlMap& section, Use use,
                                const std::vector<Setting>& found) {
  std::vector<Change> changes;
  for (const std::string& name : section.keys()) {
    const std::string wanted = section.text(name);
    const Setting* now = nullptr;
    for (const Setting& one : found)
      if (one.name == name && one.use == use && !one.value.empty()) now = &one;
    if (now == nullptr) section.refuse(name, motor.word() + " has nothing of this name here");
    if (same(now->value, wanted, now->format)) continue;
    if (use == Use::kModel)
      section.refuse(name, fmt::format("{} is another motor: it has {}, not {}. Nothing was "
                                       "written. If it replaces one of the same model, change the "
                                       "file",
                                       motor.word(), now->value, wanted));
    fmt::print("{}  {}: {}, in the file {}{}\n", motor.word(), name, now->value, wanted,
               use == Use::kOther ? ": restore does not write this" : "");
    if (use == Use::kWritable) changes.push_back({*now, number_of(section, *now), wanted});
  }
  return changes;
}

void write_changes(const Restored& one, Wire* wire) {
  const auto& [tool, number] = one.motor;
  for (const Change& change : one.changes)
    tool->write(wire, number, change.setting, change.wanted, one.fd);
  const bool stored = tool->store(wire, number, one.fd);
  for (const Setting& now : settings_of(one.motor, wire, one.fd)) {
    for (const Change& change : one.changes)
      if (change.setting.name == now.name && !same(now.value, change.text, now.format))
        throw std::runtime_error(fmt::format("{}: {} reads {} after {} was written",
                                             one.motor.word(), now.name, now.value, change.text));
  }
  fmt::print("{}  {} written and read back{}\n", one.motor.word(), one.changes.size(),
             stored ? ", stored" : "; it cannot store: lost when its supply is switched off");
}

}  // namespace

void restore(const std::string& path) {
  const YamlMap file = YamlMap::from_file(path);
  file.word("format", {kFormat});
  std::vector<BusChoice> buses;
  std::vector<Restored> motors;
  for (const YamlMap& bus : file.maps("buses")) {
    for (const YamlMap& yaml : bus.maps("motors"))
      motors.push_back(
          {motor_of(yaml.text("motor")), yaml, bus.boolean_or("fd", false), buses.size()});
    buses.push_back({bus.text("bus"), bus.boolean_or("fd", false)});
    bus.finish();
  }
  if (!file.boolean_or("complete", false))
    file.refuse_missing("complete", "it is the last line of a whole file, and true");
  file.finish();

  std::vector<Wire> wires;
  for (const BusChoice& bus : buses) wires.push_back(open(bus));
  std::size_t changes = 0;
  for (Restored& one : motors) {
    Wire* const wire = &wires[one.bus];
    require_answer(one.motor, wire, one.fd);
    const auto found = settings_of(one.motor, wire, one.fd);
    for (const auto& [section, use] : kSections)
      if (one.yaml.has(section))
        for (Change& change : differences(one.motor, one.yaml.map(section), use, found))
          one.changes.push_back(std::move(change));
    for (const char* told : {"note", "not_in_its_firmware"}) one.yaml.has(told);
    one.yaml.finish();
    require_off(one.motor, wire, one.fd);
    changes += one.changes.size();
  }
  for (const Restored& one : motors)
    if (!one.changes.empty()) write_changes(one, &wires[one.bus]);
  if (changes == 0) fmt::print("nothing to write\n");
}

}  // namespace limber::motor_tools
