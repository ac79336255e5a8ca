#include <fmt/format.h>

#include <stdexcept>

#include "drivers/protocols/mit.h"
#include "tools/can/damiao_decoder.h"
#include "tools/motors/motor_tool.h"

namespace limber::motor_tools {
namespace {

constexpr std::uint8_t kDamiaoReplyId = 7;
constexpr std::uint8_t kDamiaoNumber = 8;
constexpr std::uint8_t kDamiaoPosition = 81;  // behind the gear
constexpr std::uint8_t kDamiaoShown[] = {
    8, 7, 14, 15, 20, 10, 9, 21, 22, 23, 0, 2, kDamiaoPosition};
constexpr double kDamiaoStore_s = 0.1;  // flash takes some time

mit::Register as_register(std::uint8_t number) { return static_cast<mit::Register>(number); }
std::uint16_t as_id(int number) { return static_cast<std::uint16_t>(number); }

class DamiaoTool final : public MotorTool {
 public:
  std::string_view protocol() const noexcept override { return "damiao_mit"; }
  int last_number() const noexcept override { return 127; }

  CanFrame presence(int number, bool fd) const noexcept override {
    return mit::encode_register_read(as_id(number), as_register(kDamiaoReplyId), fd);
  }
  std::optional<Found> found(const CanFrame& frame) const override {
    if (frame.extended || frame.length != 8) return std::nullopt;
    const int number = frame.data[0] | frame.data[1] << 8;
    std::uint32_t reply = 0;
    if (!mit::decode_register(frame, as_id(number), mit::kReadRegister, as_register(kDamiaoReplyId),
                              &reply))
      return std::nullopt;
    return Found{number, fmt::format("replies as 0x{:X}", frame.id)};
  }

  std::vector<Value> show(Wire* wire, int number, bool fd) const override {
    std::vector<Value> values;
    for (const std::uint8_t reg : kDamiaoShown)
      values.push_back(bus_tools::damiao_register(reg, read(wire, number, reg, fd)));
    const mit::DriveError error = state(wire, number, fd);
    const std::string text = mit::error_text(error);
    values.push_back(
        {"state", text.empty() ? fmt::format("{:X}", static_cast<int>(error)) : text, ""});
    return values;
  }

  bool enabled(Wire* wire, int number, bool fd) const override {
    return state(wire, number, fd) == mit::DriveError::kEnabled;
  }

  void set_number(Wire* wire, int number, int wanted, bool fd) const override {
    write(wire, number, kDamiaoNumber, static_cast<std::uint32_t>(wanted), fd);
    wire->send(mit::encode_register_store(as_id(wanted), fd), kDamiaoStore_s,
               [](const CanFrame&) {});
    const std::uint32_t now = read(wire, wanted, kDamiaoNumber, fd);
    if (now != static_cast<std::uint32_t>(wanted))
      throw std::runtime_error(fmt::format("ESC_ID reads {}, not {}", now, wanted));
  }

  void set_zero(Wire* wire, int number, bool fd) const override {
    wire->send(mit::encode_special(mit::Special::kSetZero, as_id(number), fd), kDamiaoStore_s,
               [](const CanFrame&) {});
    require_zero(mit::bits_float(read(wire, number, kDamiaoPosition, fd)));
  }

 private:
  static std::uint32_t read(Wire* wire, int number, std::uint8_t reg, bool fd) {
    std::uint32_t raw = 0;
    const auto mine = [&](const CanFrame& frame) {
      return !frame.extended && frame.id != mit::kRegisterId &&
             mit::decode_register(frame, as_id(number), mit::kReadRegister, as_register(reg), &raw);
    };
    if (!wire->ask(mit::encode_register_read(as_id(number), as_register(reg), fd), mine))
      throw std::runtime_error(fmt::format("register {} is not answered", reg));
    return raw;
  }

  static void write(Wire* wire, int number, std::uint8_t reg, std::uint32_t value, bool fd) {
    std::uint32_t raw = 0;
    const auto mine = [&](const CanFrame& frame) {
      return frame.id != mit::kRegisterId &&
             mit::decode_register(frame, as_id(number), mit::kWriteRegister, as_register(reg),
                                  &raw);
    };
    if (!wire->ask(mit::encode_register_write(as_id(number), as_register(reg), value, fd), mine))
      throw std::runtime_error(fmt::format("writing register {} is not answered", reg));
    if (raw != value)
      throw std::runtime_error(
          fmt::format("register {} stays {}: the drive refused {}", reg, raw, value));
  }

  static mit::DriveError state(Wire* wire, int number, bool fd) {
    mit::Reply reply;
    const auto mine = [&](const CanFrame& frame) {
      std::uint32_t raw = 0;
      return !frame.extended && frame.id != mit::kRegisterId &&
             !mit::decode_register(frame, as_id(number), mit::kReadRegister,
                                   as_register(kDamiaoPosition), &raw) &&
             mit::decode_reply(frame, {}, &reply) && reply.id_nibble == (number & 0xF);
    };
    if (!wire->ask(mit::encode_state_request(as_id(number), fd), mine))
      throw std::runtime_error("its state is not answered");
    return reply.error;
  }
};

const DamiaoTool kDamiao;

}  // namespace

extern const MotorTool* const kDamiaoTool;
const MotorTool* const kDamiaoTool = &kDamiao;

}  // namespace limber::motor_tools
