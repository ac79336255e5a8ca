// What a user probably meant: near words, words that others use, other units.
#include <gtest/gtest.h>

#include "common/names.h"
#include "common/suggest.h"
#include "common/unit_hint.h"

namespace limber::test_suggest {
namespace {

const std::vector<std::string> kLaws = {"joint_pd", "joint_impedance", "cartesian_impedance",
                                        "cartesian_admittance", "levant"};
const std::vector<std::string> kGains = {"law", "ramp_s", "K_x_translation_N_per_m",
                                         "K_x_rotation_Nm_per_rad", "K_q_Nm_per_rad"};

TEST(DidYouMean, TheNearestWord) {
  EXPECT_EQ(did_you_mean("joint_pdd", kLaws), "did you mean 'joint_pd'?");
  EXPECT_EQ(did_you_mean("nothing_like_it", kLaws), "");
}

TEST(DidYouMean, AllThatHaveTheWordAsAPart) {
  EXPECT_EQ(did_you_mean("impedance", kLaws),
            "did you mean 'joint_impedance' or 'cartesian_impedance'?");
  EXPECT_EQ(did_you_mean("admittance", kLaws), "did you mean 'cartesian_admittance'?");
}

TEST(DidYouMean, WhatIsCalledOtherwiseHere) {
  for (const char* word : {"stiffness", "tip_stiffness", "Stiffness", "compliance", "spring"}) {
    EXPECT_EQ(did_you_mean(word, kGains),
              "did you mean 'K_x_translation_N_per_m' or "
              "'K_x_rotation_Nm_per_rad' or 'K_q_Nm_per_rad'?");
  }
  EXPECT_EQ(did_you_mean("impedance", kGains), "did you mean 'law'?");
  EXPECT_EQ(did_you_mean("impedance", {"mode", "gains", "goal"}), "did you mean 'gains'?");
}

TEST(UnitHint, NamesTheUnitThatWouldBeInside) {
  EXPECT_EQ(unit_hint("position_m", 300.0, -10.0, 10.0),
            "; are these millimetres? 0.3 m would be allowed");
  EXPECT_EQ(unit_hint("home_rad", 90.0, -2.0, 2.0),
            "; are these degrees? 1.571 rad would be allowed");
  EXPECT_EQ(unit_hint("torque_Nm", 900.0, -50.0, 50.0),
            "; are these mN m? 0.9 N m would be allowed");
  EXPECT_EQ(unit_hint("home_rad", 500.0, -2.0, 2.0), "");  // 8.7 rad: neither
  EXPECT_EQ(unit_hint("rate_hz", 1e6, 1.0, 1e4), "");
}

TEST(Names, OfFilesAndOfWhatIsShown) {
  for (const char* name : {"arm", "openarm_2.1", "my first push", "2r"})
    EXPECT_EQ(name_problem(name), "");
  for (const char* name : {"", " ", "..", ".arm", "a/b", "a ", "<b>", "a\nb", "Gr\xc3\xbc\xc3\x9f"})
    EXPECT_NE(name_problem(name), "") << name;
  EXPECT_EQ(name_problem(std::string(64, 'a')), "");
  EXPECT_NE(name_problem(std::string(65, 'a')), "");
  EXPECT_EQ(shown_name_problem("Part<1>/joint 2 \xe6\x9c\xba"), "");
  EXPECT_NE(shown_name_problem("a\tb"), "");
}

}  // namespace
}  // namespace limber::test_suggest
