// What robot.yaml's loaders, the identifier checks and the bus load know of a drive protocol: one
// object a protocol, listed once.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/yaml_reader.h"
#include "robots/loader/robot.h"

namespace limber {

/// From the end of a command to the start of the drive's reply. A guess: makers publish none.
inline constexpr double kDriveReplyDelay_s = 50e-6;

struct DriveProtocolTraits {
  DriveProtocol protocol;
  std::string_view word;      ///< `protocol:` of a motor in robot.yaml
  double enabling_s = 0.1;    ///< longest that a drive may take to be enabled
  bool needs_fd = false;      ///< its frames are longer than eight bytes
  bool reports_link = false;  ///< its drives can have a link encoder and a torque sensor
  bool needs_sync = false;    ///< one SYNC a cycle on each of its buses
  bool rotary_only = false;   ///< counts turns
  /// Default of a motor's `warning_temperature_degC`; infinite: its drives report none.
  double warning_temperature_degC = std::numeric_limits<double>::infinity();
  /// Likewise of its `limit_temperature_degC`.
  double limit_temperature_degC = std::numeric_limits<double>::infinity();
  /// Keys of a motor, or of a joint, that only this protocol has.
  std::span<const char* const> keys = {};

  /// Reads what only this protocol's motors have, `range` among it, once the keys of all motors are
  /// set. Throws ConfigError.
  void (*read_motor)(const YamlMap& yaml, DriveConfig* drive);
  /// Reads command_id and reply_id. Throws ConfigError.
  void (*read_ids)(const YamlMap& yaml, DriveConfig* drive);
  /// The drive's number on its bus, as its maker's tools count: "id 0x1", "node 1".
  std::string (*address)(const DriveConfig& drive);
  /// The frames between driver and drive in a cycle; of a second motor see second_motor.h. `fd`:
  /// the bus carries FD frames.
  FrameSizes (*frames)(const JointConfig& joint, bool fd);
  /// Whether the protocol uses an identifier besides command_id and reply_id. nullptr: none.
  bool (*reserves_id)(const DriveConfig& drive, std::uint32_t id) = nullptr;
  /// Whether the drive acts on frames with this 11-bit identifier, too. nullptr: on none.
  bool (*accepts_id)(const DriveConfig& drive, std::uint32_t id) = nullptr;
};

extern const DriveProtocolTraits kDamiaoMitTraits;
extern const DriveProtocolTraits kMoteusTraits;
extern const DriveProtocolTraits kCia402Traits;

const DriveProtocolTraits& traits_of(DriveProtocol protocol) noexcept;
/// `word` is one of protocol_words().
const DriveProtocolTraits& traits_of(const std::string& word);
std::vector<std::string> protocol_words();
/// The words of the protocols whose drives report the link's side, for messages: "a or b".
std::string link_protocol_words();

/// Refuses keys that only motors of another protocol have.
void refuse_foreign_keys(const YamlMap& yaml, const DriveProtocolTraits& traits);

/// Whether the identifier on its bus is the drive's own or reserved by its protocol.
bool uses_id(const DriveConfig& drive, std::uint32_t id);
/// Whether a frame of another node with this identifier would reach the drive.
bool accepts_id(const DriveConfig& drive, std::uint32_t id);

}  // namespace limber
