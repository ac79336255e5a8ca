// Every type of message, by its place in the alphabet.
#pragma once

#include <cstdint>
#include <limber/compliance_gains_t.hpp>
#include <limber/compliance_goal_t.hpp>
#include <limber/controller_status_t.hpp>
#include <limber/driver_status_t.hpp>
#include <limber/joint_command_t.hpp>
#include <limber/joint_state_t.hpp>
#include <limber/law_parameter_t.hpp>
#include <limber/mode_request_t.hpp>
#include <limber/push_t.hpp>
#include <limber/request_answer_t.hpp>
#include <limber/scenario_event_t.hpp>
#include <limber/sim_truth_t.hpp>
#include <optional>
#include <span>
#include <vector>

#include "common/decode_message.h"

namespace limber::fuzz {

template <typename Message>
std::optional<std::vector<std::uint8_t>> encoded_again(std::span<const std::uint8_t> bytes) {
  Message message;
  if (!decode_message(bytes.data(), bytes.size(), &message)) return std::nullopt;
  std::vector<std::uint8_t> again(static_cast<std::size_t>(message.getEncodedSize()));
  const int size = message.encode(again.data(), 0, static_cast<int>(again.size()));
  again.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
  return again;
}

using EncodedAgain = std::optional<std::vector<std::uint8_t>> (*)(std::span<const std::uint8_t>);

inline constexpr EncodedAgain kMessageTypes[] = {
    encoded_again<compliance_gains_t>,
    encoded_again<compliance_goal_t>,
    encoded_again<controller_status_t>,
    encoded_again<driver_status_t>,
    encoded_again<joint_command_t>,
    encoded_again<joint_state_t>,
    encoded_again<law_parameter_t>,
    encoded_again<mode_request_t>,
    encoded_again<push_t>,
    encoded_again<request_answer_t>,
    encoded_again<scenario_event_t>,
    encoded_again<sim_truth_t>,
};

/// The bytes as a message of type `type` (counted round), encoded anew; nothing if refused.
inline std::optional<std::vector<std::uint8_t>> decoded_and_encoded(
    std::uint8_t type, std::span<const std::uint8_t> bytes) {
  return kMessageTypes[type % std::size(kMessageTypes)](bytes);
}

}  // namespace limber::fuzz
