// Which requests from outside belong to this run: what stops a replayed log.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "controller/kinds/refusal.h"

namespace limber {

/// A request names the run of the controller it is meant for and has a number that is greater than
/// that of its client's last one. So a recording of another run, or of this one, is refused. It
/// stops mistakes, not attackers. A stop needs neither.
class RequestGuard {
 public:
  static constexpr std::size_t kMostClients = 64;

  /// `controller`: the number of this run, as in CONTROLLER_STATUS.
  explicit RequestGuard(std::int64_t controller) noexcept : controller_(controller) {}

  /// Nothing: new and meant for this run, and noted as the client's last; else why not. Neither
  /// allocates nor throws.
  Refusal check(std::int64_t controller, std::int64_t client, std::int64_t seq) noexcept;

 private:
  struct Client {
    std::int64_t client;
    std::int64_t newest_seq;
  };

  std::int64_t controller_;
  std::array<Client, kMostClients> clients_{};
  std::size_t count_ = 0;
};

}  // namespace limber
