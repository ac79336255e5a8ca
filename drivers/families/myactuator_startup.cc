// Start-up of MyActuator drives:
//
//   the firmware has robot.yaml's ranges -> the model is robot.yaml's -> time-out := watchdog_s
//     -> errors are told at once -> status
//
// The time-out cannot be read, but what it is set to is repeated in the answer. A drive whose
// time-out of an earlier run is over repeats its first request, whatever it is: a version of 0. The
// status is requested again while the drive is on, and read by the codec.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "drivers/families/myactuator_family.h"
#include "drivers/protocols/myactuator.h"
#include "robots/loader/protocols/myactuator_series.h"

namespace limber {
namespace {

using myactuator::Firmware;
using myactuator::Order;

class MyactuatorStartup final : public StartupDialogue {
 public:
  explicit MyactuatorStartup(const DriveConfig& drive)
      : number_(myactuator_number(drive)),
        firmware_(myactuator::firmware_of(drive.range)),
        most_Nm_(drive.range.torque_Nm) {
    const auto timeout_ms = static_cast<std::uint32_t>(std::lround(1e3 * drive.watchdog_s));
    requests_ = {myactuator::order_frame(Order::kVersion, number_),
                 myactuator::model_frame(number_, 1),
                 myactuator::model_frame(number_, 2),
                 myactuator::order_frame(Order::kTimeout, number_, std::max(timeout_ms, 1U)),
                 myactuator::function_frame(myactuator::Function::kTellErrors, number_, 1),
                 myactuator::order_frame(Order::kStatus, number_)};
  }

  CanFrame presence_request() const noexcept override { return requests_[kVersion]; }
  bool is_presence(const CanFrame& frame) const noexcept override {
    return myactuator::answers(frame, Order::kVersion, number_);
  }

  int steps() const noexcept override { return kSteps; }
  StartupStep step(int index) const noexcept override {
    const CanFrame& request = requests_[static_cast<std::size_t>(index)];
    const double expected = index == kSecondLetters ? most_Nm_ : myactuator::value_of(request);
    return {request.data[0], expected, index != kStatus};
  }
  CanFrame request(int index) const noexcept override {
    return requests_[static_cast<std::size_t>(index)];
  }
  bool can_be_polled(int index) const noexcept override { return index == kStatus; }
  Answer check_answer(int index, const CanFrame& frame, double* found) noexcept override {
    const CanFrame& request = requests_[static_cast<std::size_t>(index)];
    if (index == kStatus ||
        !myactuator::answers(frame, static_cast<Order>(request.data[0]), number_))
      return Answer::kNone;
    *found = myactuator::value_of(frame);
    switch (index) {
      case kVersion:
        if (*found == 0.0) return Answer::kNotYet;
        return right_if(myactuator::firmware_of(myactuator::value_of(frame)) == firmware_);
      case kFirstLetters:
        model_ = {};
        model_.add(frame);
        return Answer::kRight;
      case kSecondLetters:
        model_.add(frame);
        *found = model_.series();
        return right_if(firmware_ == Firmware::kV42 || fits(model_.series()));
      default:
        return right_if(*found == myactuator::value_of(request));
    }
  }
  std::string describe(const StartupFailure& failure) const override;

 private:
  enum Step { kVersion, kFirstLetters, kSecondLetters, kTimeout, kTellErrors, kStatus, kSteps };
  static Answer right_if(bool right) noexcept { return right ? Answer::kRight : Answer::kWrong; }

  /// From V4.4 on the torque of a command depends on the model.
  bool fits(int series) const noexcept {
    return series_with(most_Nm_) == (is_listed(series) ? series : 0);
  }

  int number_;
  Firmware firmware_;
  double most_Nm_;
  std::array<CanFrame, kSteps> requests_;
  myactuator::ModelText model_;
};

std::string MyactuatorStartup::describe(const StartupFailure& failure) const {
  if (failure.reg == 0) return StartupDialogue::describe(failure);
  const bool answered = failure.answer != Answer::kNone;
  switch (static_cast<Order>(failure.reg)) {
    case Order::kVersion:
      return fmt::format(
          "its firmware {}, robot.yaml has firmware: {}; V4.2 is of dates before {}, V4.4 from it "
          "on, and their commands have other ranges",
          answered && failure.found != 0.0 ? fmt::format("is of {:.0f}", failure.found)
                                           : "cannot be read",
          name_of(firmware_), myactuator::kFirstV44);
    case Order::kModel:
      if (!answered) return "its model (B5) cannot be read";
      return fmt::format(
          "it is {}, of which a command does not reach to {:g} N m (model)",
          failure.found == 0.0 ? "no X6, X8, ..." : fmt::format("an X{:.0f}", failure.found),
          failure.expected);
    case Order::kTimeout:
      return answered ? fmt::format("its time-out (B3) is {:.0f} ms, expected {:.0f}",
                                    failure.found, failure.expected)
                      : "its time-out (B3) cannot be set";
    default:
      return "it does not report errors at once (function 3 of order 20)";
  }
}

}  // namespace

std::unique_ptr<StartupDialogue> myactuator_startup(const JointConfig& joint) {
  return std::make_unique<MyactuatorStartup>(joint.drive);
}

}  // namespace limber
