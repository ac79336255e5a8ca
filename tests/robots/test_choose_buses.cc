// Addresses of the command line in place of robot.yaml's.
#include <gtest/gtest.h>

#include "common/config_error.h"
#include "robots/loader/choose_buses.h"

namespace limber::test_choose_buses {
namespace {

Robot two_buses() {
  Robot robot;
  robot.name = "arm";
  robot.buses.resize(2);
  robot.buses[0].name = "left";
  robot.buses[0].can = "virtual:l";
  robot.buses[1].name = "right";
  robot.buses[1].can = "socketcan:can0";
  return robot;
}

TEST(ChooseBuses, ReplacesTheNamedAddressOnly) {
  Robot robot = two_buses();
  choose_buses({{"right", "virtual:r"}}, &robot);
  EXPECT_EQ(robot.buses[0].can, "virtual:l");
  EXPECT_EQ(robot.buses[1].can, "virtual:r");
}

TEST(ChooseBuses, NamesTheBusesThereAre) {
  Robot robot = two_buses();
  try {
    choose_buses({{"middle", "virtual:m"}}, &robot);
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(),
                 "--bus middle=virtual:m: arm has no bus 'middle'; it has: left, right");
  }
}

TEST(ChooseBuses, ASimulatorGoesToARealInterfaceOnlyByName) {
  const Robot robot = two_buses();
  EXPECT_THROW(require_simulated_buses({}, robot), ConfigError);
  EXPECT_THROW(require_simulated_buses({{"left", "virtual:l"}}, robot), ConfigError);
  EXPECT_NO_THROW(require_simulated_buses({{"right", "socketcan:can0"}}, robot));
  try {
    require_simulated_buses({}, robot);
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("limber run --no-sim"), std::string::npos);
  }
}

}  // namespace
}  // namespace limber::test_choose_buses
