#include <gtest/gtest.h>

#include <limber/joint_state_t.hpp>

#include "drivers/drives_text.h"

namespace limber::test_drives_text {
namespace {

using State = joint_state_t;

bool begins(const std::string& text, const std::string& with) { return text.rfind(with, 0) == 0; }

TEST(DrivesText, WithoutAFaultItIsTheState) {
  EXPECT_EQ(drives_text(State::DRIVE_ENABLING, State::FAULT_NONE, "", ""), "drives: enabling");
  EXPECT_EQ(drives_text(State::DRIVE_FAULT, State::FAULT_NONE, "", ""), "drives: fault");
  EXPECT_EQ(drives_text(100, State::FAULT_NONE, "", ""), "drives: unknown");
}

TEST(DrivesText, AFaultHasCodeJointAndDetailAndIsAWarning) {
  const std::string text =
      drives_text(State::DRIVE_HOLD, State::FAULT_DRIVE_ERROR, "elbow", "error A");
  EXPECT_TRUE(begins(text, "warning: drives: fallback: driver.DRIVE_ERROR: ")) << text;
  EXPECT_NE(text.find(" (elbow): error A; "), std::string::npos) << text;
}

TEST(DrivesText, WhatWasRequestedIsNoWarning) {
  const std::string text = drives_text(State::DRIVE_DAMP, State::FAULT_REQUESTED, "", "");
  EXPECT_TRUE(begins(text, "drives: damp: driver.REQUESTED: ")) << text;
}

TEST(DrivesText, AFaultIsExplainedOnce) {
  EXPECT_EQ(drives_text_again(State::DRIVE_FAULT, State::FAULT_BUS),
            "drives: fault; still driver.BUS");
  EXPECT_EQ(drives_text_again(State::DRIVE_ON, State::FAULT_NONE), "drives: on");
}

}  // namespace
}  // namespace limber::test_drives_text
