#include "lab/frame_log.h"

#include <algorithm>
#include <array>

namespace limber {

FrameLog::FrameLog(const std::string& path, const Robot& robot, Lab* lab)
    : file_(path), ends_(lab->attach()) {
  for (const BusConfig& bus : robot.buses) interfaces_.push_back(candump_interface(bus.can));
}

void FrameLog::write_cycle(std::int64_t cycle_ns) {
  frames_.clear();
  std::array<CanFrame, 64> received;
  for (std::size_t bus = 0; bus < ends_.size(); ++bus) {
    for (int count; (count = ends_[bus]->receive(received)) > 0;) {
      for (int i = 0; i < count; ++i) {
        const CanFrame& frame = received[static_cast<std::size_t>(i)];
        const std::int64_t time_ns = frame.timestamp_ns != 0 ? frame.timestamp_ns : cycle_ns;
        frames_.push_back({time_ns, interfaces_[bus], frame});
      }
    }
  }
  std::ranges::stable_sort(frames_, {}, &LoggedFrame::time_ns);
  for (const LoggedFrame& frame : frames_) file_.write(frame);
}

}  // namespace limber
