// Is this JOINT_STATE new, complete and fit to be acted on?
#pragma once

#include <cstdint>
#include <limber/joint_state_t.hpp>

namespace limber::controller {

struct StateJudgement {
  bool repeated = false;      ///< its number was seen before in this session: nothing may advance
  bool first = false;         ///< the first state of all
  bool new_session = false;   ///< another run of the driver
  bool usable = false;        ///< this arm's joint count, all numbers finite, sensible period
  bool fresh = false;         ///< usable, and every joint has answered in this cycle
  bool joint_silent = false;  ///< a joint has not answered for longer than is bridged
  std::int64_t missed = 0;    ///< states between the last one and this one
};

/// Follows the stream by session and number. All members may be called in the cycle.
class StateJudge {
 public:
  /// `oldest_joint`: for so many cycles a joint may be silent; the driver has its own opinion.
  explicit StateJudge(int joints, int oldest_joint = 2) : joints_(joints), oldest_joint_(oldest_joint) {}
  StateJudgement judge(const joint_state_t& state) noexcept;

  std::int64_t received() const noexcept { return received_; }
  std::int64_t lost() const noexcept { return lost_; }

 private:
  int joints_;
  int oldest_joint_;
  std::int64_t session_ = 0;
  std::int64_t seq_ = -1;
  std::int64_t received_ = 0;
  std::int64_t lost_ = 0;
};

}  // namespace limber::controller
