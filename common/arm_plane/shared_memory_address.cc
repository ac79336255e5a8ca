#include "common/arm_plane/shared_memory_address.h"

#include <algorithm>
#include <cctype>
#include <sstream>
#include <string_view>

#include "common/config_error.h"
#include "common/local_address.h"

namespace limber {
namespace {

bool is_name(const std::string& text) {
  const auto is_allowed = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '-' || c == '_';
  };
  return !text.empty() && text.size() <= 64 && std::all_of(text.begin(), text.end(), is_allowed);
}

}  // namespace

SharedMemoryAddress parse_shared_memory_address(const std::string& url) {
  const auto question = std::min(url.find('?'), url.size());
  const std::string name =
      url.substr(kSharedMemoryScheme.size(), question - kSharedMemoryScheme.size());
  SharedMemoryAddress address;
  address.place.what = "arm plane shm:" + name;
  address.place.path = "/dev/shm/limber-arm-" + name;
  if (!is_name(name))
    throw ConfigError(address.place.what +
                      ": a name has 1 to 64 letters, digits, '-' and '_', as in shm:openarm");
  constexpr std::string_view kGroup = "group=";
  std::istringstream options(url.substr(std::min(question + 1, url.size())));
  for (std::string option; std::getline(options, option, '&');) {
    if (option == "poll") {
      address.poll = true;
    } else if (option.starts_with(kGroup) && option.size() > kGroup.size()) {
      address.place.group = option.substr(kGroup.size());
    } else {
      throw ConfigError(address.place.what + ": option '" + option +
                        "' is not known; poll and group=GROUP are");
    }
  }
  return address;
}

}  // namespace limber
