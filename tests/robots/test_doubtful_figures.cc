// Figures of a robot.yaml that contradict each other are noted with what is likelier.
#include <gtest/gtest.h>

#include <algorithm>

#include "robots/loader/load_robot.h"
#include "tests/support/mutation.h"
#include "tests/support/source_path.h"

namespace limber::test_doubtful_figures {
namespace {

using testing::Mutation;

const std::string kArm = source_path("robots/desktop2r");

std::vector<std::string> notes(const std::string& yaml, const std::string& urdf) {
  const testing::TemporaryFolder folder;
  folder.write("robot.yaml", yaml);
  const std::string file = folder.write("robot.urdf", urdf);
  return load_robot(file.substr(0, file.rfind('/'))).notes;
}

struct DoubtfulFigure : ::testing::TestWithParam<Mutation> {};

TEST_P(DoubtfulFigure, IsNotedWithItsLine) {
  const std::string good = testing::read_text(kArm + "/robot.yaml");
  const std::string urdf = testing::read_text(kArm + "/robot.urdf");
  EXPECT_TRUE(notes(good, urdf).empty());
  const testing::Mutated changed = testing::apply(good, GetParam());
  const auto found = notes(changed.text, urdf);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NE(found[0].find("robot.yaml:" + std::to_string(changed.line) + ": "), std::string::npos)
      << found[0];
  EXPECT_NE(found[0].find(GetParam().expect), std::string::npos) << found[0];
}

const std::string kRange = "velocity_rad_per_s: 30, torque_Nm: 10";
const Mutation kFigures[] = {
    {"FrictionInThousandths", "coulomb_Nm: 0.05", "coulomb_Nm: 217.9",
     "31.1 times the torque of the joint, 7: its motor could not move it; it would be 1.53 N m"},
    {"FrictionMoreThanHalf", "coulomb_Nm: 0.05", "coulomb_Nm: 4", "most of it is lost"},
    {"ViscousPerDegree", "viscous_Nms_per_rad: 0.03", "viscous_Nms_per_rad: 4",
     "the torque of the joint is 7; per degree? 0.0698 would be per radian"},
    {"RangesExchanged", kRange, "velocity_rad_per_s: 10, torque_Nm: 30",
     "VMAX 10 and TMAX 30 with a peak torque of 7 N m: are they exchanged?"},
    {"RangesOfNoTableExchanged", kRange, "velocity_rad_per_s: 9, torque_Nm: 33",
     "near the peak torque"},
    {"ConstantInMilli", "rotor_torque_constant_Nm_per_A: 0.0945",
     "rotor_torque_constant_Nm_per_A: 0.0003", "would take 2.33e+03 A"},
    {"InertiaInGramsAndCentimetres", "rotor_inertia_kgm2: 1.8e-5", "rotor_inertia_kgm2: 0.18",
     "g cm^2 are 1e-7 kg m^2"},
};
INSTANTIATE_TEST_SUITE_P(OfRobotYaml, DoubtfulFigure, ::testing::ValuesIn(kFigures),
                         testing::MutationName());

TEST(DoubtfulFigures, ShippedRobotsHaveNone) {
  for (const char* name : {"openarm", "panda", "iiwa14", "baxter", "ideal7", "antagonist2r"}) {
    for (const std::string& note : load_robot(name).notes)
      EXPECT_EQ(note.find("robot.yaml"), std::string::npos) << note;
  }
}

}  // namespace
}  // namespace limber::test_doubtful_figures
