// Every type of message, by its place in the alphabet.
#pragma once

#include <cstdint>
#include <limber/compliance_gains_t.hpp>
#include <limber/compliance_goal_t.hpp>
#include <limber/controller_status_t.hpp>
#include <limber/driver_status_t.hpp>
#include <limber/hand_goal_t.hpp>
#include <limber/hand_state_t.hpp>
#include <limber/hand_truth_t.hpp>
#include <limber/joint_command_t.hpp>
#include <limber/joint_state_t.hpp>
#include <limber/law_parameter_t.hpp>
#include <limber/mode_request_t.hpp>
#include <limber/push_t.hpp>
#include <limber/request_answer_t.hpp>
#include <limber/robot_info_t.hpp>
#include <limber/scenario_event_t.hpp>
#include <limber/sim_truth_t.hpp>
#include <optional>
#include <span>
#include <vector>

#include "common/decode_message.h"

namespace limber::fuzz {

using Bytes = std::vector<std::uint8_t>;

struct MessageType {
  std::int64_t fingerprint;
  std::optional<Bytes> (*encoded_again)(std::span<const std::uint8_t>);
};

template <typename Message>
MessageType message_type() {
  return {Message::getHash(), [](std::span<const std::uint8_t> bytes) -> std::optional<Bytes> {
            Message message;
            if (!decode_message(bytes.data(), bytes.size(), &message)) return std::nullopt;
            Bytes again(static_cast<std::size_t>(message.getEncodedSize()));
            const int size = message.encode(again.data(), 0, static_cast<int>(again.size()));
            again.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
            return again;
          }};
}

/// Type `number` (counted round) in alphabetical order.
inline const MessageType& message_type_of(std::uint8_t number) {
  static const MessageType kTypes[] = {
      message_type<compliance_gains_t>(),  message_type<compliance_goal_t>(),
      message_type<controller_status_t>(), message_type<driver_status_t>(),
      message_type<hand_goal_t>(),         message_type<hand_state_t>(),
      message_type<hand_truth_t>(),        message_type<joint_command_t>(),
      message_type<joint_state_t>(),       message_type<law_parameter_t>(),
      message_type<mode_request_t>(),      message_type<push_t>(),
      message_type<request_answer_t>(),    message_type<robot_info_t>(),
      message_type<scenario_event_t>(),    message_type<sim_truth_t>(),
  };
  return kTypes[number % std::size(kTypes)];
}

/// An input of the target `messages`: the type's number, and the message behind its fingerprint, so
/// that kept inputs outlive a change of the type. Returns the message as it is on the wire.
inline Bytes with_fingerprint(std::span<const std::uint8_t> input) {
  Bytes bytes;
  const std::int64_t fingerprint = message_type_of(input[0]).fingerprint;
  for (int shift = 56; shift >= 0; shift -= 8)
    bytes.push_back(static_cast<std::uint8_t>(fingerprint >> shift));
  bytes.insert(bytes.end(), input.begin() + 1, input.end());
  return bytes;
}

}  // namespace limber::fuzz
