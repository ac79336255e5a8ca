// An adapter's settings against robot.yaml.
#include <gtest/gtest.h>

#include "drivers/interface_check.h"

namespace limber::test_interface_check {
namespace {

using Lines = std::vector<std::string>;

BusConfig fd_bus() {
  BusConfig bus;
  bus.fd = true;
  return bus;
}
LinkDetails good() { return {"can", 64, 1'000'000, 5'000'000, true, 100, {}}; }

TEST(InterfaceCheck, NothingIsSaidOfTheRightOne) {
  EXPECT_EQ(compare(fd_bus(), good()).wrong, Lines());
  EXPECT_EQ(compare(fd_bus(), good()).doubtful, Lines());
  LinkDetails rounded = good();
  rounded.bitrate = 999'000;
  EXPECT_EQ(compare(fd_bus(), rounded).wrong, Lines());
}

TEST(InterfaceCheck, WrongRatesAreNamed) {
  LinkDetails link = good();
  link.bitrate = 500'000;
  link.data_bitrate = 2'000'000;
  EXPECT_EQ(compare(fd_bus(), link).wrong,
            Lines({"bit rate 500000, robot.yaml has 1000000",
                   "data bit rate 2000000, robot.yaml has 5000000"}));
  link = good();
  link.fd = false;
  EXPECT_EQ(compare(fd_bus(), link).wrong, Lines({"CAN-FD is off, robot.yaml has fd: true"}));
  EXPECT_EQ(compare(BusConfig(), link).wrong, Lines());
}

TEST(InterfaceCheck, WhatWorksUntilSomethingHappensIsAWarning) {
  LinkDetails link = good();
  link.restart_ms = 0;
  link.queue_frames = 10;
  link.state = CanControllerState::kErrorPassive;
  const InterfaceFindings found = compare(fd_bus(), link);
  EXPECT_EQ(found.wrong, Lines());
  EXPECT_EQ(found.doubtful,
            Lines({"its transmit queue holds 10 frames: txqueuelen 64 takes a cycle of any arm",
                   "restart-ms is 0: a bus-off lasts until somebody restarts it",
                   "its controller is error-passive: check wiring, termination and bit rate"}));
}

TEST(InterfaceCheck, ABusOffControllerIsWrong) {
  LinkDetails link = good();
  link.state = CanControllerState::kBusOff;
  EXPECT_EQ(compare(fd_bus(), link).wrong,
            Lines({"its controller is bus-off: check wiring, termination and bit rate"}));
}

TEST(InterfaceCheck, AVirtualInterfaceHasNothingToCompare) {
  LinkDetails link;
  link.kind = "vcan";
  EXPECT_EQ(compare(fd_bus(), link).wrong, Lines());
  EXPECT_EQ(compare(fd_bus(), link).doubtful, Lines());
}

}  // namespace
}  // namespace limber::test_interface_check
