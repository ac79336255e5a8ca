// Other masters of a Damiao drive.
#include <algorithm>
#include <array>

#include "drivers/families/damiao_family.h"
#include "drivers/protocols/mit.h"

namespace limber {
namespace {

constexpr int kForeignCycles = 100;

class DamiaoIntruders final : public IntruderRules {
 public:
  explicit DamiaoIntruders(const DriveConfig& drive) : drive_(drive) {}

  void begin_cycle() noexcept override;
  /// Frames with its identifier, and register writes to it.
  bool is_foreign_command(const CanFrame& frame) const noexcept override;
  /// A register's answer looks like a state: only a request tells them apart.
  void record_foreign(const CanFrame& frame) noexcept override;
  bool answers_foreign(const CanFrame& frame) noexcept override;

 private:
  /// A register that somebody else reads or writes.
  struct ForeignRequest {
    std::uint8_t operation = 0;
    std::uint8_t reg = 0;
    int cycles_left = 0;  ///< in which the answer may come
  };

  std::uint16_t id() const noexcept { return static_cast<std::uint16_t>(drive_.command_id); }

  DriveConfig drive_;
  std::array<ForeignRequest, 8> foreign_;  ///< a ring: nobody requests more at a time
  std::size_t next_foreign_ = 0;
};

bool DamiaoIntruders::is_foreign_command(const CanFrame& frame) const noexcept {
  if (has_id(frame, drive_.command_id)) return true;
  mit::RegisterRequest request;
  return mit::decode_register_request(frame, &request) && request.id == id() &&
         (request.operation == mit::kWriteRegister || request.operation == mit::kStoreRegister);
}

void DamiaoIntruders::record_foreign(const CanFrame& frame) noexcept {
  mit::RegisterRequest request;
  if (!mit::decode_register_request(frame, &request) || request.id != id()) return;
  if (request.operation != mit::kReadRegister && request.operation != mit::kWriteRegister) return;
  foreign_[next_foreign_++ % foreign_.size()] = {request.operation, request.reg, kForeignCycles};
}

bool DamiaoIntruders::answers_foreign(const CanFrame& frame) noexcept {
  std::uint32_t raw = 0;
  const auto asked = std::ranges::find_if(foreign_, [&](const ForeignRequest& request) {
    return request.cycles_left > 0 &&
           mit::decode_register(frame, id(), request.operation,
                                static_cast<mit::Register>(request.reg), &raw);
  });
  if (asked == foreign_.end()) return false;
  asked->cycles_left = 0;
  return true;
}

void DamiaoIntruders::begin_cycle() noexcept {
  for (ForeignRequest& request : foreign_)
    request.cycles_left = std::max(0, request.cycles_left - 1);
}

}  // namespace

std::unique_ptr<IntruderRules> damiao_intruders(const JointConfig& joint) {
  return std::make_unique<DamiaoIntruders>(joint.drive);
}

}  // namespace limber
