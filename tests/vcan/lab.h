// What the tests in the CAN lab share.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "tests/support/bus_frames.h"

namespace limber::testing {

/// Runs a command line; a failure fails the test.
inline void run(const std::string& command) {
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
}

}  // namespace limber::testing
