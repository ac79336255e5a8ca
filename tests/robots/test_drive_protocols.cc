// The table of drive protocols: complete, without doubles, and its identifiers as the protocols'
// manuals give them.
#include <gtest/gtest.h>

#include <array>
#include <set>

#include "robots/loader/protocols/drive_protocol.h"

namespace limber::test_drive_protocols {
namespace {

DriveConfig drive_with(std::string_view protocol, std::uint32_t command_id,
                       std::uint32_t reply_id) {
  DriveConfig drive;
  drive.protocol = &protocol_named(protocol);
  drive.command_id = command_id;
  drive.reply_id = reply_id;
  return drive;
}

JointConfig with_sensors() {
  JointConfig joint;
  joint.link_encoder.present = true;
  joint.torque_sensor.present = true;
  return joint;
}

TEST(DriveProtocols, EveryProtocolIsFoundByItsWord) {
  const std::vector<std::string> words = protocol_words();
  EXPECT_EQ(words, (std::vector<std::string>{"damiao_mit", "moteus", "cia402", "robstride",
                                             "myactuator", "cubemars", "odrive"}));
  for (const std::string& word : words) {
    const DriveProtocol& protocol = protocol_named(word);
    EXPECT_EQ(protocol.word, word);
    ASSERT_TRUE(protocol.read_motor && protocol.read_ids && protocol.address && protocol.frames);
    if (protocol.needs_fd) continue;
    // A classic frame has eight bytes at most.
    for (const JointConfig& joint : {JointConfig(), with_sensors()}) {
      const FrameSizes sizes = protocol.frames(joint, false);
      EXPECT_LE(sizes.command, 8) << word;
      for (const int bytes : sizes.replies) EXPECT_LE(bytes, 8) << word;
    }
  }
}

TEST(DriveProtocols, ADamiaoDriveUsesItsTwoIdentifiersAlone) {
  const DriveConfig drive = drive_with("damiao_mit", 3, 0x13);
  for (std::uint32_t id = 0; id < 0x800; ++id) {
    EXPECT_EQ(uses_id(drive, id), id == 3 || id == 0x13) << id;
    EXPECT_FALSE(accepts_id(drive, id));
  }
}

// Node 5: bits 6 to 0 of the identifier are the destination, 0x7F is all nodes.
TEST(DriveProtocols, AMoteusDriveAcceptsWhateverEndsInItsNumber) {
  const DriveConfig drive = drive_with("moteus", 0x8005, 0x500);
  EXPECT_TRUE(uses_id(drive, 0x8005) && uses_id(drive, 0x500));
  for (std::uint32_t id = 0; id < 0x800; ++id)
    EXPECT_EQ(accepts_id(drive, id), id % 128 == 5 || id % 128 == 127);
}

// CiA 301, predefined connection set, node 5.
TEST(DriveProtocols, ACanopenNodeReservesItsServices) {
  const DriveConfig drive = drive_with("cia402", 0x205, 0x185);
  const std::set<std::uint32_t> used = {0x000, 0x080, 0x085, 0x185, 0x285, 0x385, 0x485,
                                        0x205, 0x305, 0x405, 0x505, 0x585, 0x605, 0x705};
  for (std::uint32_t id = 0; id < 0x800; ++id)
    EXPECT_EQ(uses_id(drive, id), used.contains(id)) << id;
}

TEST(DriveProtocols, AListWithoutARowIsNamed) {
  struct Row {
    std::string_view protocol;
    int number;
  };
  constexpr std::array kRows = {Row{"moteus", 1}, Row{"cia402", 2}};
  EXPECT_EQ(row_of(kRows, protocol_named("cia402")).number, 2);
  EXPECT_THROW(row_of(kRows, protocol_named("damiao_mit")), std::logic_error);
}

TEST(DriveProtocols, OnlyCanopenDrivesReportTheLink) {
  EXPECT_EQ(link_protocol_words(), "cia402");
  EXPECT_FALSE(protocol_named("moteus").reports_link);
}

}  // namespace
}  // namespace limber::test_drive_protocols
