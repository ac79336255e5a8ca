// A drive protocol as robot.yaml's loaders, `limber new`, the identifier checks and the bus load
// need it: one object a protocol, listed in drive_protocols.cc.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "common/yaml_reader.h"
#include "robots/loader/robot.h"

namespace limber {

/// From the end of a command to the start of the drive's reply. A guess: makers publish none.
inline constexpr double kDriveReplyDelay_s = 50e-6;
/// The highest 11-bit identifier that robot.yaml may name: 0x7FF carries Damiao's registers.
inline constexpr int kMostId = 0x7FE;

/// What a first value in robot.yaml is made from; figures at the joint.
enum class Figure : std::uint8_t { kNone, kPeakTorque, kSpeed, kHoldKp, kHoldKd };
std::string_view name_of(Figure figure) noexcept;

/// The value that `limber new` writes: factor times the figure, and at least `least`. Of a joint's
/// key: the drive's number plus `least`. `word`: instead of a number.
struct FirstValue {
  double least = 0.0;
  Figure of = Figure::kNone;
  double factor = 0.0;
  const char* word = "";
};

/// A key that every motor (section "motors.*", or "motors.*.KEY" of a mapping in it) or joint
/// ("joints.*") of a protocol has in robot.yaml.
struct ProtocolKey {
  const char* section;
  const char* key;   ///< alternatives separated by |, the usual one first
  const char* what;  ///< what it is, for people
  FirstValue first = {};
  const char* found = "datasheet";  ///< where its owner finds the true value
};

/// Request and answer of a drive's setting, eight bytes each, in a cycle.
struct SettingFrames {
  std::uint32_t request_id;
  std::uint32_t answer_id;
  bool classic;  ///< also on a CAN-FD bus
};

struct DriveProtocol {
  std::string_view word;         ///< `protocol:` of a motor in robot.yaml
  std::string_view title;        ///< its name in tables and texts
  double enabling_s = 0.1;       ///< longest that a drive may take to be enabled
  bool needs_fd = false;         ///< its frames are longer than eight bytes
  bool usually_fd = true;        ///< `limber new` writes a CAN-FD bus
  bool reports_link = false;     ///< its drives can have a link encoder and a torque sensor
  bool needs_sync = false;       ///< one SYNC a cycle on each of its buses
  bool rotary_only = false;      ///< counts turns
  bool single_turn = false;      ///< unless a motor has `keeps_turns: true`
  bool shares_reply_id = false;  ///< its drives may reply alike: the data name the sender
  bool hex_ids = false;          ///< its makers' tools write identifiers in hexadecimal digits
  const char* id_found = "node number of the drive";
  double sample_point = 0.0;  ///< that its drives want on the bus; 0: any
  double usual_gear_ratio = 1.0;
  int joints_a_bus = 1;  ///< that a bus of `limber new` carries at 1 kHz
  /// Default of a motor's `warning_temperature_degC`; infinite: its drives report none.
  double warning_temperature_degC = std::numeric_limits<double>::infinity();
  /// Likewise of its `limit_temperature_degC`.
  double limit_temperature_degC = std::numeric_limits<double>::infinity();
  /// Keys without which a motor or a joint is refused.
  std::span<const ProtocolKey> required = {};
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
  /// Frames by which the driver reads a setting while the drive is on. nullptr: it does not.
  SettingFrames (*setting)(const DriveConfig& drive) = nullptr;
  /// Whether the protocol uses an identifier besides command_id and reply_id. nullptr: none.
  bool (*reserves_id)(const DriveConfig& drive, std::uint32_t id) = nullptr;
  /// A 29-bit identifier without what of it is data, which command_id and reply_id have as 0:
  /// frames of one kind have the same. nullptr: the identifier itself.
  std::uint32_t (*kind)(std::uint32_t id) = nullptr;
  /// Whether the drive acts on frames with this 11-bit identifier, too. nullptr: on none.
  bool (*accepts_id)(const DriveConfig& drive, std::uint32_t id) = nullptr;
};

/// Every protocol there is.
std::span<const DriveProtocol* const> drive_protocols() noexcept;
/// `word` is one of protocol_words().
const DriveProtocol& protocol_named(std::string_view word);
std::vector<std::string> protocol_words();
/// The words of the protocols whose drives report the link's side, for messages: "a or b".
std::string link_protocol_words();

/// The row of a list with a `protocol` (a word) in each row. Throws std::logic_error if the list
/// does not have it: docs/adding.md names the lists.
template <typename Rows>
const auto& row_of(const Rows& rows, const DriveProtocol& protocol) {
  for (const auto& row : rows) {
    if (row.protocol == protocol.word) return row;
  }
  throw std::logic_error("a list has no row for protocol: " + std::string(protocol.word));
}

/// Refuses keys that only motors of another protocol have.
void refuse_foreign_keys(const YamlMap& yaml, const DriveProtocol& protocol);

/// Whether the identifier on its bus is the drive's own or reserved by its protocol.
bool uses_id(const DriveConfig& drive, std::uint32_t id);
/// DriveProtocol::kind of the drive's protocol. Allowed in the cycle.
std::uint32_t kind_of_id(const DriveConfig& drive, std::uint32_t id, bool extended) noexcept;
/// Whether a frame of another node with this identifier would reach the drive.
bool accepts_id(const DriveConfig& drive, std::uint32_t id);

}  // namespace limber
