// One slip in a good robot.yaml each: the complaint names file, line and key.
#include "robots/loader/load_robot.h"
#include "tests/support/mutation.h"
#include "tests/support/source_path.h"

namespace limber::test_yaml_refusals {
namespace {

using testing::Mutation;

const std::string kArm = source_path("tests/robots/data/arm/");

std::string good_yaml() { return testing::read_text(kArm + "robot.yaml"); }

std::string refusal(const std::string& yaml, std::string* file) {
  const testing::TemporaryFolder folder;
  folder.write("robot.urdf", testing::read_text(kArm + "robot.urdf"));
  *file = folder.write("robot.yaml", yaml);
  return testing::complaint_of([&] { load_robot(folder.path()); });
}

class RobotYamlRefusal : public ::testing::TestWithParam<Mutation> {};

TEST_P(RobotYamlRefusal, NamesPlaceAndProblem) {
  const testing::Mutated bad = testing::apply(good_yaml(), GetParam());
  std::string file;
  const std::string complaint = refusal(bad.text, &file);
  testing::expect_complaint(complaint, file, bad.line, GetParam().expect);
}

const Mutation kSyntax[] = {
    {"UnknownKey", "rate_hz: 500", "rate_hz: 500\nspeed: 3", "unknown key 'speed'", 1},
    {"MisspeltKey", "rate_hz: 500", "rate_hz: 500\nbusses: 3", "did you mean 'buses'?", 1},
    {"MissingKey", "rate_hz: 500", "rate_Hz: 500", "'rate_hz' is missing", testing::kNoLine},
    {"MissingKeyHint", "rate_hz: 500", "rate_Hz: 500", "is 'rate_Hz' a slip?", testing::kNoLine},
    {"DuplicateKey", "tip: hand", "tip: hand\ntip: fore", "key 'tip' is here twice", 1},
    {"Anchor", "tip: hand", "tip: &t hand", "anchors (&name) are not allowed"},
    {"Alias", "tip: hand", "tip: *t", "not valid YAML"},
    {"Tag", "tip: hand", "tip: !!binary hand", "tags (tag:yaml.org,2002:binary)"},
    {"Tab", "  timeout_s: 0.02", "\ttimeout_s: 0.02", "not valid YAML", testing::kNoLine},
    {"SecondDocument", "tip: hand", "tip: hand\n---\nname: x", "a second document", 1},
    {"NumberWithComma", "rate_hz: 500", "rate_hz: 1,5", "'1,5' is not a number"},
    {"NumberWithUnit", "rate_hz: 500", "rate_hz: 500Hz", "'500Hz' is not a number"},
    {"NumberQuoted", "rate_hz: 500", "rate_hz: \"500\"", "the text \"500\" is not a number"},
    {"NumberNan", "rate_hz: 500", "rate_hz: .nan", "'.nan' is not a number"},
    {"NumberInfinite", "rate_hz: 500", "rate_hz: .inf", "'.inf' is not a number"},
    {"NumberTooBig", "rate_hz: 500", "rate_hz: 1e999", "'1e999' is not a number"},
    {"NumberMissing", "rate_hz: 500", "rate_hz:", "found nothing; expected a number from 10 to"},
    {"NumberAsList", "rate_hz: 500", "rate_hz: [500]", "found a list; expected a number"},
    {"IntegerWithFraction", "    id: 2", "    id: 2.5", "expected a whole number from 1 to 15"},
    {"BooleanInWords", "fd: true", "fd: yes", "found 'yes'; expected true or false"},
    {"TextMissing", "name: arm", "name:", "found nothing; expected text"},
    {"NameAPath", "name: arm", "name: ../..", "'../..' is no name; expected a letter or digit"},
    {"NameInAFolder", "name: arm", "name: a/b", "'a/b' is no name"},
    {"NameWithATag", "name: arm", "name: <script>", "'<script>' is no name"},
    {"NameOfTwoLines", "name: arm", "name: \"a\\nb\"", "'a?b' is no name"},
    {"NameTooLong", "name: arm", "name: " + std::string(300, 'x'), "xxx...' is no name"},
    {"BusNameAPath", "name: left", "name: ../left", "buses[0].name: '../left' is no name"},
    {"Stiffness", "gains:", "gains:\n  stiffness: 300",
     "unknown key 'stiffness'; did you mean 'K_x_translation_N_per_m' or ", 1},
    {"ListAsMapping", "gravity_m_per_s2: [0, 0, -9.81]", "gravity_m_per_s2: {z: -9.81}",
     "found a mapping; expected a list of 3 numbers"},
    {"ListTooShort", "[0, 0, -9.81]", "[0, -9.81]", "found 2 entries; expected a list of 3"},
    {"ListEntry", "[0, 0, -9.81]", "[0, down, -9.81]", "gravity_m_per_s2: 'down' is not a number"},
};
INSTANTIATE_TEST_SUITE_P(Syntax, RobotYamlRefusal, ::testing::ValuesIn(kSyntax),
                         testing::MutationName());

const Mutation kSections[] = {
    {"Format", "limber-robot/1", "limber-robot/2", "expected one of: limber-robot/1"},
    {"RateTooHigh", "rate_hz: 500", "rate_hz: 20000", "expected a number from 10 to 10000"},
    {"RateZero", "rate_hz: 500", "rate_hz: 0", "'0' is out of range"},
    {"BusKind", "virtual:left", "vcan0",
     "expected virtual:NAME, socketcan:INTERFACE, slcan:/dev/NAME"},
    {"BusOfNoDevice", "virtual:left", "slcan:ttyACM0", "slcan:/dev/NAME"},
    {"BusOfNoBaud", "virtual:left", "dmserial:/dev/ttyACM0@fast", "@BAUD"},
    {"BusWithoutName", "virtual:left", "socketcan:", "expected virtual:NAME, socketcan"},
    {"BusInterfaceTooLong", "socketcan:can1", "socketcan:can0123456789012", "at most 15 letters"},
    {"BusNameTwice", "name: right", "name: left", "is taken by another bus"},
    {"BusTwice", "socketcan:can1", "virtual:left", "bus 'left' is on it already"},
    {"BusBitrate", ", bitrate_bps: 500000}", ", bitrate_bps: 2000000}", "from 10000 to 1000000"},
    {"BusDataBitrate", "data_bitrate_bps: 5000000", "data_bitrate_bps: 500000", "out of range"},
    {"BusDataBitrateOfAClassicBus", "fd: true, ", "fd: false, ",
     "buses[0].data_bitrate_bps: data_bitrate_bps belongs to fd: true; take it out"},
    {"BusDataBitrateWithoutFd", "fd: true, ", "",
     "data_bitrate_bps belongs to fd: true; take it out"},
    {"BusNone",
     R"(  - {name: left, can: "virtual:left", fd: true, bitrate_bps: 1000000, data_bitrate_bps: 5000000}
  - {name: right, can: "socketcan:can1", bitrate_bps: 500000})",
     "  []", "found 0; expected 1 to 4", -1},
    {"WatchdogOff", "timeout_s: 0.02", "timeout_s: 0", "'0' is out of range"},
    {"WatchdogTooShort", "timeout_s: 0.02", "timeout_s: 0.003", "shorter than two cycles at 500"},
    {"WatchdogReaction", "reaction: off", "reaction: brake", "expected one of: damp, off"},
    {"MotorProtocol", "protocol: damiao_mit", "protocol: canopen",
     "one of: damiao_mit, moteus, cia402"},
    {"MotorGear", "gear_ratio: 9", "gear_ratio: 0", "motors.big.gear_ratio: '0' is out of range"},
    {"MotorInertiaNegative", "rotor_inertia_kgm2: 0.0002", "rotor_inertia_kgm2: -0.0002", "out of"},
    {"MotorResistance", "phase_resistance_ohm: 0.2", "phase_resistance_ohm: 0", "out of range"},
    {"MotorPeakAboveRange", "peak_torque_Nm: 15", "peak_torque_Nm: 60",
     "the torque field can carry"},
    {"MotorRange", "position_rad: 12.5, ", "", "'position_rad' is missing"},
    {"GainsTooFew", "[40, 800, 5]", "[40, 800]", "found 2 entries; expected a list of 3 numbers"},
    {"GainsNegative", "[40, 800, 5]", "[40, -800, 5]", "'-800' is out of range"},
    {"GainsMissing", "  damping_ratio: 0.7", "", "gains: 'damping_ratio' is missing",
     testing::kNoLine},
    {"UrdfMissing", "urdf: robot.urdf", "urdf: arm.urdf", "urdf: no file 'arm.urdf' in"},
};
INSTANTIATE_TEST_SUITE_P(Sections, RobotYamlRefusal, ::testing::ValuesIn(kSections),
                         testing::MutationName());

const Mutation kJoints[] = {
    {"JointMissing", "  slide:\n", "  slid:\n", "joints: 'slide' is missing", testing::kNoLine},
    {"JointUnknown", "  slide:\n", "  slid:\n",
     "joints: unknown key 'slid'; did you mean 'slide'?"},
    {"JointMotor", "motor: linear", "motor: lineal", "did you mean 'linear'?"},
    {"JointBus", "bus: right", "bus: middle", "found 'middle'; expected one of: left, right"},
    {"IdZero", "    id: 2", "    id: 0", "from 1 to 15"},
    {"IdAboveFourBits", "    id: 2", "    id: 16", "from 1 to 15"},
    {"IdTaken", "    id: 2", "    id: 1", "1 is taken by turn on the same bus"},
    {"IdIsAReply", "reply_id: 17", "reply_id: 2", "2 is taken by turn on the same bus", 12},
    {"ReplyTaken", "reply_id: 18", "reply_id: 17", "17 is taken by turn on the same bus"},
    {"ReplyIsACommand", "reply_id: 18", "reply_id: 1", "1 is taken by turn on the same bus"},
    {"ReplyIsOwnCommand", "reply_id: 18", "reply_id: 2", "must differ from id"},
    {"ReplyIsTheRegisterId", "reply_id: 18", "reply_id: 2047", "from 1 to 2046"},
    {"Sign", "sign: -1", "sign: 0", "found '0'; expected 1 or -1"},
    {"SignTwo", "sign: -1", "sign: 2", "out of range"},
    {"OffsetBeyondDrive", "offset_rad: 0.7", "offset_rad: 11", "drive's position range is +-12.5",
     -5},
    {"OffsetBeyondDriveOtherEnd", "offset_rad: 0.7", "offset_rad: -11", "angles from -13 to -9",
     -5},
    {"ContinuousWithoutLimits", "    position_max_rad: 3\n", "", "drive's position range", -5},
    {"HomeOutside", "home_rad: 0.5", "home_rad: 2.2", "2.2 is outside the limits -2 to 2"},
    {"HomeInOtherUnits", "home_m: 0.1", "home_rad: 0.1", "'home_m' is missing", -4},
    {"LimitWiderThanUrdf", "position_max_rad: 2", "position_max_rad: 2.6", "above the 2.5 of the"},
    {"LimitWithoutRoom", "position_max_rad: 2", "position_max_rad: -2",
     "no room between -2 and -2"},
    {"TorqueWiderThanMotor", "torque_limit_Nm: 12", "torque_limit_Nm: 16", "wider than the 15 of"},
    {"VelocityWiderThanUrdf", "velocity_limit_m_per_s: 0.4", "velocity_limit_m_per_s: 0.6",
     "wider than the 0.5 of URDF and motor"},
    {"TorqueZero", "torque_limit_Nm: 12", "torque_limit_Nm: 0", "out of range"},
    {"FrictionNegative", "coulomb_Nm: 0.2", "coulomb_Nm: -0.2", "out of range"},
    {"FrictionStaticBelowCoulomb", "static_Nm: 0.3", "static_Nm: 0.1", "at least the coulomb"},
    {"FrictionUnits", "coulomb_N: 2", "coulomb_Nm: 2", "'coulomb_N' is missing"},
    {"HoldAboveRange", "kp_Nm_per_rad: 50,", "kp_Nm_per_rad: 501,", "from 0 to 500"},
    {"HoldDampingAboveRange", "kd_Nms_per_rad: 2}", "kd_Nms_per_rad: 5.1}", "from 0 to 5"},
    {"HoldMissing", "    hold: {kp_N_per_m: 3000, kd_Ns_per_m: 60}\n", "",
     "joints.slide: 'hold' is missing", -7},
};
INSTANTIATE_TEST_SUITE_P(Joints, RobotYamlRefusal, ::testing::ValuesIn(kJoints),
                         testing::MutationName());

/// An arm with two moteus drives and a Damiao on a slide.
std::string good_moteus_yaml() {
  const std::string text = testing::read_text(source_path("tests/robots/data/moteus/robot.yaml"));
  return testing::apply(text, {"", "../arm/robot.urdf", kArm + "robot.urdf", ""}).text;
}

class MoteusYamlRefusal : public ::testing::TestWithParam<Mutation> {};

TEST_P(MoteusYamlRefusal, NamesPlaceAndProblem) {
  const testing::Mutated bad = testing::apply(good_moteus_yaml(), GetParam());
  std::string file;
  const std::string complaint = refusal(bad.text, &file);
  testing::expect_complaint(complaint, file, bad.line, GetParam().expect);
}

const std::string kGains = "    pid_position: {kp_Nm_per_turn: 400, kd_Nms_per_turn: 20}\n";
const std::string kRanges =
    "    mit_range: {position_rad: 1, velocity_rad_per_s: 2, torque_Nm: 200, kp_Nm_per_rad: 5000, "
    "kd_Nms_per_rad: 100}\n";

const Mutation kMoteus[] = {
    {"RangesOfAnotherProtocol", kGains, kGains + kRanges,
     "mit_range: is for motors with protocol: damiao_mit only", 1},
    {"GainsOfAnotherProtocol", kRanges, kRanges + kGains,
     "pid_position: is for motors with protocol: moteus only", 1},
    {"TimeoutTorqueOfAnotherProtocol", kRanges, kRanges + "    timeout_torque_Nm: 3\n",
     "timeout_torque_Nm: is for motors with protocol: moteus only", 1},
    {"GainsMissing", kGains, "", "'pid_position' is missing", -8},
    {"GainsInRadians", "kp_Nm_per_turn", "kp_Nm_per_rad", "'kp_Nm_per_turn' is missing"},
    {"GainZero", "kp_Nm_per_turn: 400", "kp_Nm_per_turn: 0", "'0' is out of range"},
    {"TimeoutTorqueAbovePeak", "timeout_torque_Nm: 3", "timeout_torque_Nm: 16", "from 0 to 15"},
    {"EncoderBits", "encoder_bits: 32", "encoder_bits: 33", "from 8 to 32"},
    {"IdOfTheHost", "id: 12", "id: 0", "from 1 to 126"},
    {"IdOfEverybody", "id: 12", "id: 127", "from 1 to 126"},
    {"IdTaken", "id: 12", "id: 3", "3 is taken by turn on the same bus"},
    {"ReplyId", "    id: 12\n", "    id: 12\n    reply_id: 18\n",
     "reply_id: is for motors with protocol: damiao_mit only", 1},
    {"ClassicBus", "    bus: left\n    id: 12", "    bus: right\n    id: 12",
     "bus: 'right' is classic; moteus drives need CAN-FD"},
    {"PrismaticJoint", "    motor: linear\n    bus: right", "    motor: turner\n    bus: left",
     "motor: moteus drives count turns"},
    {"HoldAboveTheDrives", "kp_Nm_per_rad: 50,", "kp_Nm_per_rad: 64,", "from 0 to 63.66"},
};
INSTANTIATE_TEST_SUITE_P(Moteus, MoteusYamlRefusal, ::testing::ValuesIn(kMoteus),
                         testing::MutationName());

TEST(RobotYamlRefusals, TellEverythingThatIsWrong) {
  std::string text = good_yaml();
  for (const Mutation& mutation : {Mutation{"", "    id: 2", "    id: 20", ""},
                                   Mutation{"", "home_rad: 0.5", "home_rad: 5", ""},
                                   Mutation{"", "damping_ratio: 0.7", "damping_ratio: 7", ""},
                                   Mutation{"", "rate_hz: 500", "rate_hz: fast", ""}}) {
    text = testing::apply(text, mutation).text;
  }
  std::string file;
  const std::string complaint = refusal(text, &file);
  EXPECT_EQ(std::count(complaint.begin(), complaint.end(), '\n'), 3) << complaint;
  for (const char* key : {"rate_hz", "turn.home_rad", "slide.id", "gains.joint_damping_ratio"})
    EXPECT_NE(complaint.find(key), std::string::npos) << complaint;
}

TEST(RobotYamlRefusals, UnknownRobot) {
  const std::string complaint = testing::complaint_of([] { load_robot("openarn"); });
  EXPECT_NE(complaint.find("did you mean 'openarm'?"), std::string::npos) << complaint;
  EXPECT_NE(
      complaint.find(
          "one of: antagonist2r, antagonist7, axol, baxter, desktop2r, desktop2r_ak, "
          "desktop2r_odrive, edulite_a3, ideal7, iiwa14, openarm, "
          "openarm_left, openarm_right, panda, planar2r, rebot_b601_dm, testbench, trlc_dk1, yam"),
      std::string::npos)
      << complaint;
  testing::complaint_of([] { load_robot(""); });
  testing::complaint_of([] { load_robot("/nowhere"); });
}

}  // namespace
}  // namespace limber::test_yaml_refusals
