// limber-can: what is said on the buses of an arm, decoded, counted, recorded, sent again,
// described for other tools.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "common/config_error.h"
#include "common/program.h"
#include "common/realtime.h"
#include "drivers/can/candump_log.h"
#include "robots/loader/choose_buses.h"
#include "robots/loader/load_robot.h"
#include "tools/can/bus_decoder.h"
#include "tools/can/dbc_messages.h"
#include "tools/can/frame_source.h"
#include "tools/can/nodes_text.h"
#include "tools/can/replay.h"
#include "tools/can/statistics.h"

using namespace limber;
using namespace limber::bus_tools;

namespace {

struct Arguments {
  int (*run)(const Arguments&) = nullptr;  ///< the command that was given
  std::string robot;
  std::map<std::string, std::string> buses;
  std::string file;
  double duration_s = 0.0;
  std::string out;
  bool force = false;
  std::string only;
};

Robot load(const Arguments& given) {
  Robot robot = load_robot(given.robot).robot;
  if (!robot.has_drives) throw ConfigError(given.robot + " has no drives");
  choose_buses(given.buses, &robot);
  return robot;
}

FrameSource source_of(const Arguments& given) {
  return {given.file, given.duration_s, &stop_on_signals()};
}

void warn_of_losses(const Robot& robot, const ListeningLosses& losses) {
  if (!losses.elsewhere.empty()) spdlog::info("left out: {}", elsewhere_text(robot, losses));
  if (losses.overflow > 0)
    spdlog::warn("{} frames were lost on their way here: the machine is too busy", losses.overflow);
  if (losses.malformed > 0) spdlog::warn("{} datagrams that were no CAN frames", losses.malformed);
}

std::string line(double time_s, const BusConfig& bus, const CanFrame& frame,
                 const Reading& reading) {
  const bool long_id = frame.extended || frame.error;
  std::string text = fmt::format("{:12.6f} {:<8} {:>8}  {:<14} {:<7}  {:<15} {}", time_s, bus.name,
                                 hex(frame.id, long_id ? 8 : 3), reading.who,
                                 word_of(reading.direction), reading.what, text_of(reading.values));
  text.erase(text.find_last_not_of(' ') + 1);
  return text + '\n';
}

int dump(const Arguments& given) {
  const Robot robot = load(given);
  std::vector<BusDecoder> decoders;
  for (int bus = 0; bus < static_cast<int>(robot.buses.size()); ++bus)
    decoders.emplace_back(robot, bus);
  const bool live = given.file.empty();
  std::int64_t start_ns = -1;
  const auto print = [&](std::int64_t time_ns, int bus, const CanFrame& frame) {
    const auto index = static_cast<std::size_t>(bus);
    if (live && start_ns < 0) start_ns = time_ns;
    const double time_s = 1e-9 * static_cast<double>(live ? time_ns - start_ns : time_ns);
    const std::string text = line(time_s, robot.buses[index], frame, decoders[index].read(frame));
    // A pipe whose reader has gone shows when it is flushed.
    return std::fputs(text.c_str(), stdout) >= 0 && std::ferror(stdout) == 0;
  };
  const auto flush = [] { std::fflush(stdout); };
  warn_of_losses(robot, each_frame(robot, source_of(given), print, flush));
  return kExitDone;
}

int stats(const Arguments& given) {
  const Robot robot = load(given);
  BusStatistics statistics(robot);
  const auto add = [&](std::int64_t time_ns, int bus, const CanFrame& frame) {
    statistics.add(time_ns, bus, frame);
    return true;
  };
  if (given.file.empty() && given.duration_s == 0.0) spdlog::info("counting until Ctrl-C");
  warn_of_losses(robot, each_frame(robot, source_of(given), add));
  std::fputs(statistics.text().c_str(), stdout);
  return kExitDone;
}

int record(const Arguments& given) {
  const Robot robot = load(given);
  raise_priority(/*paced=*/true);  // a run in lock step beside other work waits for nobody
  CandumpWriter file(given.out);
  FrameSource source = source_of(given);
  const auto write = [&](std::int64_t time_ns, int bus, const CanFrame& frame) {
    const BusConfig& config = robot.buses[static_cast<std::size_t>(bus)];
    file.write({time_ns, candump_interface(config.can), frame});
    return true;
  };
  spdlog::info("recording the buses of {} to {}", robot.name, given.out);
  const ListeningLosses losses = each_frame(robot, source, write, [&] { file.flush(); });
  file.flush();
  warn_of_losses(robot, losses);
  std::printf("%s: %lld frames\n", given.out.c_str(), static_cast<long long>(file.frames()));
  return kExitDone;
}

int send_again(const Arguments& given) {
  const ReplayCount count =
      replay(load(given), {given.file, given.force, given.only}, stop_on_signals());
  std::printf("%lld frames sent, %lld left out, %lld refused by the bus\n",
              static_cast<long long>(count.sent), static_cast<long long>(count.left_out),
              static_cast<long long>(count.refused));
  return kExitDone;
}

int write_dbc(const Arguments& given) {
  const Robot robot = load(given);
  for (int bus = 0; bus < static_cast<int>(robot.buses.size()); ++bus) {
    const std::string& name = robot.buses[static_cast<std::size_t>(bus)].name;
    const std::filesystem::path path =
        std::filesystem::path(given.out) / (robot.name + "_" + name + ".dbc");
    std::ofstream file(path);
    if (!file) throw ConfigError::at(path.string(), 0, "", "cannot be written");
    file << dbc::file_text(
        fmt::format("{}, bus {}: what limber and the drives exchange. Angles, speeds and torques "
                    "are the drives' own, before sign and offset of robot.yaml.",
                    robot.name, name),
        dbc_messages(robot, bus));
    file.close();
    if (!file) throw std::runtime_error(path.string() + ": write failed; is the disk full?");
    std::printf("%s\n", path.string().c_str());
  }
  return kExitDone;
}

int nodes(const Arguments& given) {
  std::fputs(nodes_text(load(given)).c_str(), stdout);
  return kExitDone;
}

CommandLine& add(CommandLine& program, const char* name, const char* purpose,
                 int (*run)(const Arguments&), Arguments* given) {
  auto& command = program.command(name, purpose);
  command.when_chosen([given, run] { given->run = run; });
  command.text("robot", &given->robot, "name of a shipped robot, or a folder").required();
  command.buses(&given->buses);
  return command;
}

void define(CommandLine& program, Arguments* given) {
  auto& dumped = add(program, "dump", "every frame, decoded, one a line", dump, given);
  auto& counted = add(program, "stats", "rates, gaps and load", stats, given);
  auto& recorded = add(program, "record", "all buses into a candump log", record, given);
  for (auto* command : {&dumped, &counted})
    command->text("--file", &given->file, "candump log instead of the buses");
  for (auto* command : {&dumped, &counted, &recorded})
    command->number("--duration", &given->duration_s, 0.0, 1e6, "end after so many seconds");
  recorded.text("--out", &given->out, "file to write").required();
  auto& replayed = add(program, "replay", "send a recording again", send_again, given);
  replayed.text("--file", &given->file, "candump log").required();
  replayed.flag("--force", &given->force, "also on buses that are not virtual");
  replayed.text("--only", &given->only, "commands or replies").one_of({"commands", "replies"});
  auto& described = add(program, "dbc", "one DBC file a bus, for other tools", write_dbc, given);
  described.text("--out", &given->out, "folder").required();
  add(program, "nodes", "which motors are on which bus, and how python-can joins", nodes, given);
}

}  // namespace

LIMBER_MAIN(can) {
  CommandLine line("limber-can", "What is said on the CAN buses of an arm.");
  Arguments given;
  define(line, &given);
  return run_program(line, argc, argv, [&] { return given.run(given); });
}
