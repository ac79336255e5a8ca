#include "lab/told.h"

#include <spdlog/spdlog.h>

#include "common/problem_text.h"
#include "drivers/drives_text.h"

namespace limber {

Told::Told(const Robot& robot, BlackBox* black_box)
    : joints_(robot.driven_names()), black_box_(black_box), controller_(joints_, black_box) {}

void Told::note(Lab& lab) {
  controller_.note(lab.controller_status(), lab.state());
  for (const RequestOutcome& outcome : lab.controller().timeline_outcomes())
    ControllerLog::note(answer_to(outcome, lab.state().time_ns));
  if (lab.state().fault != fault_) note_drives(lab);
}

void Told::note_drives(Lab& lab) {
  const joint_state_t& state = lab.state();
  fault_ = state.fault;
  const auto joint = static_cast<std::size_t>(state.fault_joint);
  spdlog::info(
      drives_text(state.drive_state, fault_, joint < joints_.size() ? joints_[joint] : "",
                  lab.driver().fault_text(fault_, state.fault_joint, lab.driver().fault_detail())));
  const Problem* problem = find_problem(problems::kDriver, fault_);
  const bool wanted = fault_ == joint_state_t::FAULT_REQUESTED &&
                      lab.torque().mode != controller_status_t::MODE_FAULT;
  if (problem != nullptr && !wanted) keep(black_box_, problem->code);
}

}  // namespace limber
