#include "tools/motors/dump.h"

#include <stdexcept>

namespace limber::motor_tools {
namespace {

void put_motor(YAML::Emitter* out, const Motor& motor, const std::vector<Setting>& settings) {
  *out << YAML::BeginMap << YAML::Key << "motor" << YAML::Value << motor.word();
  if (!motor.tool->not_read().empty())
    *out << YAML::Key << "note" << YAML::Value << std::string(motor.tool->not_read());
  for (const auto& [section, use] : kSections) {
    *out << YAML::Key << section << YAML::Value << YAML::BeginMap;
    for (const Setting& one : settings)
      if (one.use == use && !one.value.empty())
        *out << YAML::Key << one.name << YAML::Value << one.value;
    *out << YAML::EndMap;
  }
  *out << YAML::Key << "not_in_its_firmware" << YAML::Value << YAML::BeginSeq;
  for (const Setting& one : settings)
    if (one.value.empty()) *out << one.name;
  *out << YAML::EndSeq << YAML::EndMap;
}

}  // namespace

std::string dump(const std::vector<BusChoice>& buses) {
  YAML::Emitter out;
  out << YAML::BeginMap << YAML::Key << "format" << YAML::Value << kFormat;
  out << YAML::Key << "buses" << YAML::Value << YAML::BeginSeq;
  bool any = false;
  for (const BusChoice& bus : buses) {
    Wire wire = open(bus);
    out << YAML::BeginMap << YAML::Key << "bus" << YAML::Value << bus.address;
    out << YAML::Key << "fd" << YAML::Value << bus.fd;
    out << YAML::Key << "motors" << YAML::Value << YAML::BeginSeq;
    for (const Motor& motor : motors_on(&wire, bus.fd)) {
      any = true;
      put_motor(&out, motor, settings_of(motor, &wire, bus.fd));
    }
    out << YAML::EndSeq << YAML::EndMap;
  }
  out << YAML::EndSeq << YAML::Key << "complete" << YAML::Value << true << YAML::EndMap;
  if (!any) throw std::runtime_error("no motor answers; `limber motors scan` tells more");
  return std::string(
             "# `limber motors restore` writes what stands under settings, where a "
             "motor has another\n# value; model has to agree, the rest is compared.\n") +
         out.c_str() + "\n";
}

}  // namespace limber::motor_tools
