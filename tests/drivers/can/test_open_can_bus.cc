// What a user reads who has written something into `can:` that cannot be opened.
#include <gtest/gtest.h>
#include <linux/can.h>
#include <sys/socket.h>
#include <unistd.h>

#include <string>

#include "common/config_error.h"
#include "drivers/can/can_bus.h"

namespace limber::test_open_can_bus {
namespace {

std::string refusal(const std::string& address) {
  try {
    open_can_bus(address, true);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "opened";
}

TEST(OpenCanBus, UnknownKindsAreToldBothForms) {
  for (const char* address : {"", "can0", "pcan:can0", "virtual:", "socketcan:", ":can0"}) {
    EXPECT_NE(refusal(address).find("socketcan:INTERFACE"), std::string::npos) << refusal(address);
    EXPECT_NE(refusal(address).find("virtual:NAME"), std::string::npos) << refusal(address);
  }
}

TEST(OpenCanBus, SocketCanTellsWhatThisKernelLacks) {
  const int probe = socket(PF_CAN, SOCK_RAW, CAN_RAW);
  const bool kernel_has_can = probe >= 0;
  if (kernel_has_can) close(probe);
  const std::string reason = refusal("socketcan:nosuch0");
  EXPECT_EQ(reason.find("socketcan:nosuch0: "), 0U) << reason;
  EXPECT_NE(reason.find(kernel_has_can ? "no such interface" : "modprobe can_raw"),
            std::string::npos)
      << reason;
  EXPECT_NE(reason.find(kernel_has_can ? "type vcan" : "virtual:NAME"), std::string::npos)
      << reason;
}

}  // namespace
}  // namespace limber::test_open_can_bus
