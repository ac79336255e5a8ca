// A simulator on in-memory buses, and a driver's end of them that speaks the MIT protocol.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <span>
#include <vector>

#include "drivers/can/lockstep_frame.h"
#include "drivers/can/memory_bus.h"
#include "drivers/protocols/mit.h"
#include "robots/loader/load_robot.h"
#include "sim/simulator.h"

namespace limber::testing {

/// A driver's end of the buses, reduced to what a test wants to say.
class Bench {
 public:
  Bench(const LoadedRobot& robot, const SimulatorOptions& options) : robot_(robot) {
    std::vector<CanBus*> ends;
    for (std::size_t i = 0; i < robot.robot.buses.size(); ++i) {
      buses_.push_back(std::make_unique<MemoryBus>());
      arm_ends_.push_back(buses_.back()->attach());
      ends_.push_back(buses_.back()->attach());
      ends.push_back(arm_ends_.back().get());
    }
    simulator_ = std::make_unique<Simulator>(robot, ends, options);
  }

  Simulator& simulator() { return *simulator_; }
  CanBus& end(int bus) { return *ends_[bus]; }

  void send(int joint, mit::Special special) {
    const DriveConfig& drive = robot_.robot.joints[joint].drive;
    end(drive.bus).send(mit::encode_special(special, drive.command_id, false));
  }
  void send(int joint, const mit::Command& command) {
    send(robot_.robot.joints[joint].drive, command);
  }
  void send(const DriveConfig& drive, const mit::Command& command) {
    CanFrame frame;
    ASSERT_TRUE(mit::encode_command(command, drive.range, drive.command_id, false,
                                    mit::Quantiser::kRound, &frame));
    end(drive.bus).send(frame);
  }
  void send(int joint, mit::Register reg, std::uint32_t value) {
    const DriveConfig& drive = robot_.robot.joints[joint].drive;
    end(drive.bus).send(mit::encode_register_write(static_cast<std::uint16_t>(drive.command_id),
                                                   reg, value, false));
  }
  void tick(std::int64_t number) {
    for (const auto& one : ends_) one->send(lockstep::tick(number));
  }
  /// TICK on all buses; true if a period was advanced.
  bool cycle(std::int64_t number) {
    tick(number);
    return simulator_->poll();
  }
  /// All frames that wait on a bus.
  std::vector<CanFrame> take(int bus) {
    std::vector<CanFrame> out;
    CanFrame frame;
    while (end(bus).receive(std::span(&frame, 1)) == 1) out.push_back(frame);
    return out;
  }
  int tocks(int bus, std::int64_t number) {
    int count = 0;
    for (const CanFrame& frame : take(bus)) {
      count += lockstep::is_tock(frame) && lockstep::sequence(frame) == number ? 1 : 0;
    }
    return count;
  }

 private:
  LoadedRobot robot_;
  std::vector<std::unique_ptr<MemoryBus>> buses_;
  std::vector<std::unique_ptr<CanBus>> arm_ends_;
  std::vector<std::unique_ptr<CanBus>> ends_;
  std::unique_ptr<Simulator> simulator_;
};

}  // namespace limber::testing
