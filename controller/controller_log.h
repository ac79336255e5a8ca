// What the controller's process and the lab log: changes of the mode, refused requests.
#pragma once

#include <limber/controller_status_t.hpp>
#include <limber/request_answer_t.hpp>
#include <string>
#include <vector>

#include "common/black_box/black_box.h"
#include "controller/request_outcome.h"
#include "controller/watches/init_watch.h"

namespace limber {

/// A request's outcome as REQUEST_ANSWER; `time_ns`: arm time. Allocates.
request_answer_t answer_to(const RequestOutcome& outcome, std::int64_t time_ns);

/// After a cycle's answer has gone out, never before. Lines that a user has to see at once begin
/// with "warning: ". Allocates where something is logged.
class ControllerLog {
 public:
  /// `joints`: names for messages.
  /// `black_box`: where the last seconds are kept at a fault; may be null.
  explicit ControllerLog(std::vector<std::string> joints, BlackBox* black_box = nullptr)
      : joints_(std::move(joints)), black_box_(black_box) {}

  /// A line if the mode, or the cause of its last change, is another one than before. A fault keeps
  /// the black box, unless somebody wanted the drives to stop.
  /// `driver_fault`: joint_state_t FAULT_*, of the state that the status describes.
  void note(const controller_status_t& status, std::int8_t driver_fault);
  /// The same of an answered state; also which joint keeps the controller in INIT.
  void note(const controller_status_t& status, const joint_state_t& state);
  /// A line if the request was refused.
  static void note(const request_answer_t& answer);

 private:
  std::vector<std::string> joints_;
  BlackBox* black_box_;
  std::int8_t mode_ = controller_status_t::MODE_BOOT;
  std::int8_t reason_ = controller_status_t::REASON_NONE;
  InitWatch init_;
};

}  // namespace limber
