// Arms of one motor for tests of the bus tools, and frames written as candump writes them.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "drivers/can/candump_log.h"
#include "robots/loader/protocols/drive_protocol.h"
#include "robots/loader/robot.h"
#include "tools/can/bus_decoder.h"

namespace limber::testing {

/// "003#8A3C", "00008004##1 .."; blanks count for nothing.
inline CanFrame candump_frame(std::string text) {
  std::erase(text, ' ');
  LoggedFrame logged;
  EXPECT_TRUE(from_candump("(0.0) can0 " + text, &logged)) << text;
  return logged.frame;
}

/// One joint "elbow" on bus "arm"; ranges, gains and encoder are JointConfig's defaults.
inline Robot one_motor(std::string_view protocol, std::uint32_t command_id,
                       std::uint32_t reply_id) {
  Robot robot;
  robot.name = "one";
  robot.has_drives = true;
  BusConfig bus;
  bus.name = "arm";
  bus.can = "virtual:one";
  bus.fd = true;
  robot.buses = {bus};
  JointConfig joint;
  joint.name = "elbow";
  joint.torque_limit_Nm = 5.0;
  joint.drive.protocol = &protocol_named(protocol);
  joint.drive.command_id = command_id;
  joint.drive.reply_id = reply_id;
  joint.drive.rated_torque_Nm = 28.0;
  robot.joints = {joint};
  return robot;
}

/// "elbow command MIT command: position 1 rad, ..."
inline std::string said(bus_tools::BusDecoder& decoder, const std::string& frame) {
  const bus_tools::Reading reading = decoder.read(candump_frame(frame));
  return reading.who + " " + word_of(reading.direction) + " " + reading.what + ": " +
         bus_tools::text_of(reading.values);
}

}  // namespace limber::testing
