#include "drivers/protocols/moteus.h"
#include "tools/can/dbc_signals.h"
#include "tools/can/moteus_decoder.h"

namespace limber::bus_tools {
namespace {

using dbc::Message;
using dbc::Signal;

/// The values that a frame writes or answers, where they lie in it.
std::vector<Signal> register_signals(const CanFrame& frame, moteus::Subframe::Kind kind) {
  std::vector<Signal> signals;
  moteus::FrameReader reader(frame);
  moteus::Subframe subframe;
  while (reader.next(&subframe)) {
    if (subframe.kind != kind) continue;
    const int bytes = moteus::size_of(subframe.type);
    for (unsigned i = 0; i < subframe.count; ++i) {
      const auto reg = static_cast<std::uint16_t>(subframe.first + i);
      const MoteusRegisterText text = moteus_register(reg);
      const auto byte =
          static_cast<int>(subframe.data - frame.data.data()) + bytes * static_cast<int>(i);
      Signal signal{dbc::identifier(text.name), 8 * byte, 8 * bytes};
      signal.is_float = subframe.type == moteus::Type::kFloat;
      signal.is_signed = true;
      signal.scale = moteus::lsb(reg, subframe.type);
      signal.unit = text.unit;
      if (!signal.is_float) set_full_range(&signal);
      signals.push_back(std::move(signal));
    }
  }
  return signals;
}

/// The answer to what a frame asks for, as drives lay it out: in the order of the request.
CanFrame answer_to(const CanFrame& request, std::uint32_t id) {
  moteus::FrameWriter answer(id);
  moteus::FrameReader reader(request);
  moteus::Subframe subframe;
  while (reader.next(&subframe)) {
    if (subframe.kind != moteus::Subframe::Kind::kRead) continue;
    const std::vector<double> zeros(subframe.count, 0.0);
    answer.reply(subframe.type, subframe.first, zeros);
  }
  return answer.frame();
}

}  // namespace

void add_moteus_messages(const Motor& motor, const BusFacts& /*bus*/,
                         std::vector<Message>* messages) {
  const DriveConfig& drive = motor.joint.drive;
  const CanFrame command = moteus::encode_command({}, drive.command_id);
  const CanFrame answer = answer_to(command, drive.reply_id);
  Message to = message_of(motor, "command", drive.command_id, true, command.length, true);
  to.comment =
      "Limber's command in position mode. Other frames of this identifier are other rows of "
      "registers: stop is 01 00 00 and a request of the state.";
  to.signals = register_signals(command, moteus::Subframe::Kind::kWrite);
  Message from = message_of(motor, "state", drive.reply_id, true, answer.length, false);
  from.comment = "Answer to limber's command. Other requests have answers of another layout.";
  from.signals = register_signals(answer, moteus::Subframe::Kind::kReply);
  messages->push_back(std::move(to));
  messages->push_back(std::move(from));
}

}  // namespace limber::bus_tools
