#include "robots/loader/joint_chain_yaml.h"

#include <fmt/format.h>

#include <cmath>

#include "robots/loader/protocols/drive_protocol.h"

namespace limber {
namespace {

const JointUnits kRotary = {"_rad",      "_rad_per_s",  "_Nm",
                            "_Nm_per_s", "_Nm_per_rad", "_Nms_per_rad"};
const JointUnits kLinear = {"_m", "_m_per_s", "_N", "_N_per_s", "_N_per_m", "_Ns_per_m"};
constexpr Range kStiffness = {1e-3, 1e7};
constexpr Range kSteepness = {1e-3, 1e3};

// Keys per power of the joint's unit: _Nm_per_rad2, _N_per_m2.
std::string power_key(const std::string& name, const JointUnits& units, int power) {
  return fmt::format("{}{}{}", name, units.stiffness, power);
}

SpringConfig read_spring(const YamlMap& yaml, const JointUnits& units) {
  SpringConfig spring;
  const std::string law = yaml.word("law", {"linear", "quadratic", "cubic", "exponential", "sinh"});
  if (law == "linear" || law == "cubic")
    spring.stiffness_Nm_per_rad = yaml.number("stiffness" + units.stiffness, kStiffness);
  if (law == "cubic") {
    spring.law = SpringLaw::kCubic;
    spring.k3_Nm_per_rad3 = yaml.number(power_key("k3", units, 3), {0.0, 1e8});
  } else if (law == "quadratic") {
    spring.law = SpringLaw::kQuadratic;
    spring.k2_Nm_per_rad2 = yaml.number(power_key("k2", units, 2), kStiffness);
  } else if (law == "exponential" || law == "sinh") {
    spring.law = law == "sinh" ? SpringLaw::kSinh : SpringLaw::kExponential;
    spring.force_Nm = yaml.number("force" + units.force, {1e-9, 1e6});
    spring.rate_per_rad = yaml.number("rate_per" + units.position, kSteepness);
  }
  if (law != "linear" && law != "cubic")
    yaml.leave_to("law: linear or cubic", {"stiffness" + units.stiffness});
  if (law != "cubic") yaml.leave_to("law: cubic", {power_key("k3", units, 3)});
  if (law != "quadratic") yaml.leave_to("law: quadratic", {power_key("k2", units, 2)});
  if (law != "exponential" && law != "sinh") {
    yaml.leave_to("law: exponential or sinh", {"force" + units.force, "rate_per" + units.position});
  }
  yaml.finish();
  return spring;
}

TransmissionKind read_kind(const YamlMap& yaml, bool two_motors) {
  const std::string word = yaml.word("kind", {"rigid", "elastic", "antagonistic"});
  if (two_motors != (word == "antagonistic")) {
    yaml.refuse("kind", two_motors ? "a joint with an antagonist needs kind: antagonistic"
                                   : "antagonistic needs a second motor (antagonist)");
  }
  if (word == "rigid") return TransmissionKind::kRigid;
  return two_motors ? TransmissionKind::kAntagonistic : TransmissionKind::kElastic;
}

void read_preload(const YamlMap& yaml, const JointUnits& units, TransmissionConfig* transmission) {
  const std::string at_rest = "preload" + units.position;
  const std::string most = "preload_max" + units.position;
  if (transmission->kind != TransmissionKind::kAntagonistic) {
    for (const std::string& key : {at_rest, most}) {
      if (yaml.has(key)) yaml.refuse(key, "is for antagonistic joints only");
    }
    return;
  }
  transmission->preload_max_rad = yaml.number(most, {1e-4, 100.0});
  transmission->preload_rad = yaml.number(at_rest, {0.0, transmission->preload_max_rad});
  const SpringLaw law = transmission->spring.law;
  const bool needs_preload = law == SpringLaw::kQuadratic;
  if (needs_preload && transmission->preload_rad == 0.0)
    yaml.refuse(at_rest, "0 leaves the joint without stiffness; expected more");
}

TransmissionConfig read_transmission(const YamlMap& yaml, const JointUnits& units,
                                     bool two_motors) {
  TransmissionConfig transmission;
  transmission.kind = read_kind(yaml, two_motors);
  if (transmission.kind != TransmissionKind::kRigid) {
    transmission.spring = read_spring(yaml.map("spring"), units);
    transmission.damping_Nms_per_rad = yaml.number_or("damping" + units.damping, {0.0, 1e4}, 0.0);
    transmission.backlash_rad = yaml.number_or("backlash" + units.position, {0.0, 0.5}, 0.0);
  }
  read_preload(yaml, units, &transmission);
  yaml.finish();
  return transmission;
}

EncoderErrors read_encoder_errors(const YamlMap& yaml, const JointUnits& units) {
  EncoderErrors errors;
  errors.bias_rad = yaml.number_or("bias" + units.position, {-1.0, 1.0}, 0.0);
  errors.eccentricity_rad = yaml.number_or("eccentricity" + units.position, {0.0, 0.1}, 0.0);
  errors.noise_rad = yaml.number_or("noise" + units.position, {0.0, 0.1}, 0.0);
  errors.delay_s = yaml.number_or("delay_s", {0.0, 0.01}, 0.0);
  return errors;
}

LinkEncoderConfig read_link_encoder(const YamlMap& yaml, const JointUnits& units) {
  LinkEncoderConfig encoder;
  encoder.present = true;
  encoder.bits = static_cast<int>(yaml.integer("bits", 8, 26));
  encoder.errors = read_encoder_errors(yaml, units);
  yaml.finish();
  return encoder;
}

TorqueSensorConfig read_torque_sensor(const YamlMap& yaml, const JointUnits& units) {
  constexpr Range kTorque = {0.0, 100.0};
  TorqueSensorConfig sensor;
  sensor.present = true;
  sensor.resolution_Nm = yaml.number_or("resolution" + units.force, kTorque, 0.0);
  sensor.noise_Nm = yaml.number_or("noise" + units.force, kTorque, 0.0);
  sensor.bias_Nm = yaml.number_or("bias" + units.force, {-100.0, 100.0}, 0.0);
  sensor.scale = yaml.number_or("scale", {0.1, 10.0}, 1.0);
  sensor.filter_s = yaml.number_or("filter_s", {0.0, 0.1}, 0.0);
  sensor.delay_s = yaml.number_or("delay_s", {0.0, 0.01}, 0.0);
  yaml.finish();
  return sensor;
}

TorqueLoopConfig read_torque_loop(const YamlMap& yaml, double rate_hz, const JointConfig& joint) {
  if (!joint.drive.protocol->reports_link)
    yaml.refuse(fmt::format("is for motors with protocol: {} only: the loop runs in the drive",
                            link_protocol_words()));
  if (!joint.torque_sensor.present) yaml.refuse("needs a torque_sensor");
  if (joint.transmission.kind != TransmissionKind::kElastic)
    yaml.refuse("needs transmission: {kind: elastic}");
  TorqueLoopConfig loop;
  loop.inertia_ratio = yaml.number("inertia_ratio", {1.0, 100.0});
  loop.rate_hz = yaml.number("rate_hz", {rate_hz, 20'000.0});
  const double loops = loop.rate_hz / rate_hz;
  if (std::abs(loops - std::round(loops)) > 1e-9 * loops) {
    yaml.refuse("rate_hz", fmt::format("{} is no multiple of the {} Hz of the control cycle",
                                       loop.rate_hz, rate_hz));
  }
  loop.delay_s = yaml.number_or("delay_s", {0.0, 0.01}, 0.0);
  yaml.finish();
  return loop;
}

}  // namespace

FrictionConfig read_friction(const YamlMap& yaml, const JointUnits& units) {
  FrictionConfig friction;
  friction.coulomb_Nm = yaml.number("coulomb" + units.force, {0.0, 1000.0});
  friction.static_Nm = yaml.number_or("static" + units.force, {0.0, 1000.0}, friction.coulomb_Nm);
  if (!(friction.static_Nm >= friction.coulomb_Nm))
    yaml.refuse("static" + units.force, "must be at least the coulomb friction");
  friction.viscous_Nms_per_rad = yaml.number("viscous" + units.damping, {0.0, 1000.0});
  friction.stribeck_rad_per_s =
      yaml.number_or("stribeck" + units.velocity, {1e-6, 100.0}, friction.stribeck_rad_per_s);
  friction.bristle_rad =
      yaml.number_or("bristle" + units.position, {1e-7, 0.1}, friction.bristle_rad);
  yaml.finish();
  return friction;
}

const JointUnits& units_of(const JointConfig& joint) {
  return joint.type == JointType::kPrismatic ? kLinear : kRotary;
}

void read_joint_chain(const YamlMap& yaml, double rate_hz, JointConfig* joint) {
  const JointUnits& units = units_of(*joint);
  if (yaml.has("transmission")) {
    joint->transmission = read_transmission(yaml.map("transmission"), units, joint->has_antagonist);
  } else if (joint->has_antagonist) {
    yaml.refuse("antagonist", "needs transmission: {kind: antagonistic}");
  }
  if (yaml.has("friction")) joint->friction = read_friction(yaml.map("friction"), units);
  if (yaml.has("link_friction"))
    joint->link_friction = read_friction(yaml.map("link_friction"), units);
  if (yaml.has("motor_encoder")) {
    const YamlMap errors = yaml.map("motor_encoder");
    joint->motor_encoder = read_encoder_errors(errors, units);
    errors.finish();
  }
  if (yaml.has("link_encoder"))
    joint->link_encoder = read_link_encoder(yaml.map("link_encoder"), units);
  if (yaml.has("torque_sensor"))
    joint->torque_sensor = read_torque_sensor(yaml.map("torque_sensor"), units);
  if (yaml.has("torque_loop"))
    joint->torque_loop = read_torque_loop(yaml.map("torque_loop"), rate_hz, *joint);
  if (!joint->drive.protocol->reports_link &&
      (joint->link_encoder.present || joint->torque_sensor.present)) {
    yaml.refuse(
        "motor",
        fmt::format("only drives with protocol: {} report a link encoder or a torque sensor",
                    link_protocol_words()));
  }
}

}  // namespace limber
