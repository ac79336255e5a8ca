#include "tests/added_family/toy.h"
#include "tools/can/dbc_signals.h"

namespace limber::bus_tools {
namespace {

class ToyDecoder final : public FrameDecoder {
 public:
  explicit ToyDecoder(const Motor& motor) : name_(motor.name), drive_(motor.joint.drive) {}
  std::optional<Reading> read(const CanFrame& frame) override {
    toy::Command command;
    if (toy::decode(frame, drive_.command_id, &command))
      return Reading{name_,
                     Direction::kCommand,
                     "toy command",
                     {{"torque", number(command.values[4]), "N m"}}};
    toy::State state;
    if (toy::decode(frame, drive_.reply_id, &state))
      return Reading{
          name_, Direction::kReply, "toy state", {{"angle", number(state.values[0]), "rad"}}};
    return std::nullopt;
  }

 private:
  std::string name_;
  DriveConfig drive_;
};

}  // namespace

std::unique_ptr<FrameDecoder> make_toy_decoder(const Motor& motor) {
  return std::make_unique<ToyDecoder>(motor);
}

void add_toy_messages(const Motor& motor, const BusFacts& /*bus*/,
                      std::vector<dbc::Message>* messages) {
  messages->push_back(message_of(motor, "command", motor.joint.drive.command_id, true, 24, true));
}

}  // namespace limber::bus_tools
