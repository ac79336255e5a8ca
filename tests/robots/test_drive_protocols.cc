// The table of drive protocols: complete, without doubles, and its identifiers as the protocols'
// manuals give them.
#include <gtest/gtest.h>

#include <set>

#include "robots/loader/protocols/drive_protocol.h"

namespace limber::test_drive_protocols {
namespace {

DriveConfig drive_with(DriveProtocol protocol, std::uint32_t command_id, std::uint32_t reply_id) {
  DriveConfig drive;
  drive.protocol = protocol;
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

TEST(DriveProtocols, EveryProtocolIsFoundByItsWordAndItsNumber) {
  const std::vector<std::string> words = protocol_words();
  EXPECT_EQ(words, (std::vector<std::string>{"damiao_mit", "moteus", "cia402"}));
  std::set<DriveProtocol> protocols;
  for (const std::string& word : words) {
    const DriveProtocolTraits& traits = traits_of(word);
    EXPECT_EQ(traits.word, word);
    EXPECT_EQ(&traits_of(traits.protocol), &traits);
    EXPECT_TRUE(protocols.insert(traits.protocol).second) << word;
    ASSERT_TRUE(traits.read_motor && traits.read_ids && traits.frames);
    if (traits.needs_fd) continue;
    // A classic frame has eight bytes at most.
    for (const JointConfig& joint : {JointConfig(), with_sensors()}) {
      const FrameSizes sizes = traits.frames(joint, false);
      EXPECT_LE(sizes.command, 8) << word;
      for (const int bytes : sizes.replies) EXPECT_LE(bytes, 8) << word;
    }
  }
}

TEST(DriveProtocols, ADamiaoDriveUsesItsTwoIdentifiersAlone) {
  const DriveConfig drive = drive_with(DriveProtocol::kDamiaoMit, 3, 0x13);
  for (std::uint32_t id = 0; id < 0x800; ++id) {
    EXPECT_EQ(uses_id(drive, id), id == 3 || id == 0x13) << id;
    EXPECT_FALSE(accepts_id(drive, id));
  }
}

// Node 5: bits 6 to 0 of the identifier are the destination, 0x7F is all nodes.
TEST(DriveProtocols, AMoteusDriveAcceptsWhateverEndsInItsNumber) {
  const DriveConfig drive = drive_with(DriveProtocol::kMoteus, 0x8005, 0x500);
  EXPECT_TRUE(uses_id(drive, 0x8005) && uses_id(drive, 0x500));
  for (std::uint32_t id = 0; id < 0x800; ++id)
    EXPECT_EQ(accepts_id(drive, id), id % 128 == 5 || id % 128 == 127);
}

// CiA 301, predefined connection set, node 5.
TEST(DriveProtocols, ACanopenNodeReservesItsServices) {
  const DriveConfig drive = drive_with(DriveProtocol::kCia402, 0x205, 0x185);
  const std::set<std::uint32_t> used = {0x000, 0x080, 0x085, 0x185, 0x285, 0x385, 0x485,
                                        0x205, 0x305, 0x405, 0x505, 0x585, 0x605, 0x705};
  for (std::uint32_t id = 0; id < 0x800; ++id)
    EXPECT_EQ(uses_id(drive, id), used.contains(id)) << id;
}

TEST(DriveProtocols, OnlyCanopenDrivesReportTheLink) {
  EXPECT_EQ(link_protocol_words(), "cia402");
  EXPECT_FALSE(traits_of(DriveProtocol::kMoteus).reports_link);
}

}  // namespace
}  // namespace limber::test_drive_protocols
