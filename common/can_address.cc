#include "common/can_address.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace limber {
namespace {

struct Kind {
  std::string_view word;
  CanCarrier carrier;
  int baud;
};
constexpr std::array<Kind, 4> kKinds = {{{"virtual", CanCarrier::kVirtual, 0},
                                         {"socketcan", CanCarrier::kSocketCan, 0},
                                         {"slcan", CanCarrier::kSlcan, 1'000'000},
                                         {"dmserial", CanCarrier::kDamiaoSerial, 921'600}}};

/// What follows the last @, unless there is none.
bool take_baud(std::string* place, int* baud) {
  const auto at = place->rfind('@');
  if (at == std::string::npos) return true;
  const char* const end = place->data() + place->size();
  const auto [rest, error] = std::from_chars(place->data() + at + 1, end, *baud);
  const bool whole = error == std::errc() && rest == end && *baud > 0;
  place->resize(at);
  return whole;
}

}  // namespace

std::optional<CanAddress> can_address(const std::string& text) {
  const auto colon = text.find(':');
  const auto* const kind =
      std::ranges::find(kKinds, std::string_view(text).substr(0, colon), &Kind::word);
  if (colon == std::string::npos || kind == kKinds.end()) return std::nullopt;
  CanAddress found{kind->carrier, text.substr(colon + 1), kind->baud};
  const bool whole =
      !found.serial() || (take_baud(&found.place, &found.baud) && found.place.starts_with('/'));
  return whole && !found.place.empty() ? std::optional(found) : std::nullopt;
}

}  // namespace limber
