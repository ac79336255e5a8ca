// A scenario file: which arm, which world, what happens when. The same file drives `limber run`
// (three processes) and `limber lab` (one process); each process takes its own part of the
// timeline, by arm time, so that nothing depends on when a message happens to arrive.
#pragma once

#include <cstdint>
#include <limber/compliance_gains_t.hpp>
#include <limber/compliance_goal_t.hpp>
#include <limber/hand_goal_t.hpp>
#include <limber/mode_request_t.hpp>
#include <limber/push_t.hpp>
#include <limber/scenario_event_t.hpp>
#include <limber/target_stream_t.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "lcmtypes/gains_table.h"
#include "robots/loader/load_robot.h"
#include "scenarios/loader/object_config.h"

namespace limber {

using ScenarioMessage = std::variant<mode_request_t, compliance_goal_t, compliance_gains_t,
                                     target_stream_t, hand_goal_t, push_t, scenario_event_t>;

struct TimedMessage {
  std::int64_t time_ns =
      0;  ///< arm time at which it acts: the first cycle whose time is not before it
  ScenarioMessage message;
};

/// Key `wire`: what the simulated buses do in lock step. Probabilities are per frame.
struct WireOptions {
  bool on = false;          ///< frames take time; without, they arrive at once
  double loss = 0.0;        ///< arrives, but its receiver drops it; the sender does not know
  double corruption = 0.0;  ///< ends in an error frame and is sent again
  double delay_s = 0.0;     ///< each way, beyond what the adapter's class takes
  std::uint64_t seed = 1;
};

/// Key `measure`: how far what `limber run` measures may be off, relative.
struct MeasureTolerances {
  double stiffness = 0.02;
  double contact_force = 0.02;
};

enum class Integrator : std::uint8_t { kOde, kReference };

struct Scenario {
  std::string name;
  std::string path;
  std::string robot;                   ///< name or folder, as written
  std::vector<std::string> law_files;  ///< none or one: scenario_laws()
  bool lockstep = true;                ///< the file's wish; the command line may say otherwise
  double duration_s = 10.0;
  std::uint64_t seed = 1;
  Integrator integrator = Integrator::kOde;
  double step_s = 250e-6;  ///< integration step; a whole number of them makes a control period
  bool friction = true;
  double friction_factor = 1.0;  ///< times robot.yaml's, in `plant`; 0: none
  bool allow_unstable = false;   ///< gains known to be unstable act, with a warning; else refused
  bool record = true;            ///< `limber run` keeps a log
  MeasureTolerances measure;
  WireOptions wire;
  bool stand = true;  ///< the arm is carried at its start pose until the drives hold it
  /// The simulated arm, where it differs from what drives and controller believe.
  std::optional<LoadedRobot> plant;
  std::vector<ObjectConfig> objects;   ///< for the hand
  std::vector<double> start_q;         ///< pose of the simulated arm at time zero; defaults to home
  std::vector<TimedMessage> timeline;  ///< sorted by time, file order within the same time
};

/// The lease every scenario's requests use.
inline constexpr std::int64_t kScenarioClient = 0x5343454E;

/// Reads and checks a scenario against its robot. Throws ConfigError (file, line, key, value, what
/// is allowed). `laws`: the controller's (controller/laws/registry.h); nullptr for a process that
/// runs none, such as the simulator: entries `gains` are then left out.
Scenario load_scenario(const std::string& path, const LoadedRobot& robot, const LawCatalog* laws);

/// Only the robot's name or folder, to load it first: a folder beside the scenario file comes
/// before a shipped robot of the same name, and relative paths are taken from there. `note`, if
/// given, tells which was taken where both exist. Throws ConfigError.
std::string scenario_robot(const std::string& path, std::string* note = nullptr);

/// Only `law_file`, to load it first: none or one, relative to the scenario. Throws
/// ConfigError.
std::vector<std::string> scenario_laws(const std::string& path);

/// Walks the timeline. due() returns the next message whose time has come, or nullptr; no
/// allocation.
class Timeline {
 public:
  explicit Timeline(const std::vector<TimedMessage>* messages) : messages_(messages) {}
  const ScenarioMessage* due(std::int64_t time_ns) noexcept;
  /// The same without going past it; when it is due stands in TimedMessage::time_ns.
  const TimedMessage* peek(std::int64_t time_ns) const noexcept;
  /// Starts over (a new driver session).
  void rewind() noexcept { next_ = 0; }

 private:
  const std::vector<TimedMessage>* messages_;
  std::size_t next_ = 0;
};

}  // namespace limber
