#include "controller/request_guard.h"

#include <algorithm>

namespace limber {

Refusal RequestGuard::check(std::int64_t controller, std::int64_t client,
                            std::int64_t seq) noexcept {
  if (controller != controller_) {
    return {request_answer_t::REFUSED_OTHER_RUN,
            "meant for another run of the controller, or recorded: `controller` must be the number "
            "in CONTROLLER_STATUS"};
  }
  if (client == 0) return {request_answer_t::REFUSED_CLIENT, "client must not be 0"};
  const auto end = clients_.begin() + static_cast<std::ptrdiff_t>(count_);
  const auto known = std::find_if(clients_.begin(), end,
                                  [client](const Client& entry) { return entry.client == client; });
  if (known != end) {
    if (seq <= known->newest_seq)
      return {request_answer_t::REFUSED_REPEATED,
              "received before: seq must be greater than that of this client's last request"};
    known->newest_seq = seq;
    return {};
  }
  if (count_ == kMostClients)
    return {request_answer_t::REFUSED_CLIENT, "more clients than 64 in one run of the controller"};
  clients_[count_++] = {client, seq};
  return {};
}

}  // namespace limber
