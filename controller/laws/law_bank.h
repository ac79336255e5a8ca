// The laws an arm can run: which is selected, which runs.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "controller/laws/registry.h"

namespace limber::controller {

/// One instance of each law that the arm has the sensors for. HOLD runs joint_pd with nothing of
/// the user's choices; ACTIVE runs the selected law. After construction all members may be called
/// in the cycle.
class LawBank {
 public:
  /// `simulated`: every bus is; only then laws that demonstrate a mistake are allowed. Throws
  /// ConfigError if there is no law of this name or the arm cannot run it.
  LawBank(const LawArm& arm, const std::string& selected, bool simulated);

  int selected() const noexcept { return selected_; }
  void select(int law) noexcept { selected_ = law; }

  /// The law that runs, and whether for HOLD.
  const LawEntry& running() const noexcept { return entry(running_); }
  int running_index() const noexcept { return running_; }
  bool holding() const noexcept { return holding_; }
  Law& instance() noexcept { return *laws_[static_cast<std::size_t>(running_)]; }
  void run_hold() noexcept { run(hold_, true); }
  void run_selected() noexcept { run(selected_, false); }

  static const LawEntry& entry(int law) noexcept { return laws()[static_cast<std::size_t>(law)]; }
  /// nullptr if the arm can run the law with these gains, else why not.
  const char* check(int law, const Gains& gains) const noexcept;

 private:
  void run(int law, bool holding) noexcept {
    running_ = law;
    holding_ = holding;
  }
  const char* check_entry(const LawEntry& entry) const noexcept;
  int find(const std::string& name) const;

  unsigned sensors_;
  bool simulated_;
  std::vector<std::unique_ptr<Law>> laws_;  // by registry index; empty where the arm lacks a sensor
  int hold_;
  int selected_;
  int running_;
  bool holding_ = true;
};

}  // namespace limber::controller
