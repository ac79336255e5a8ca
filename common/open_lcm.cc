#include "common/open_lcm.h"

#include <sys/resource.h>

#include "common/config_error.h"
#include "common/lcm_url.h"
#include "common/multicast_socket.h"

namespace limber {

namespace {

/// LCM ends the process when it finds no descriptor for a pipe.
void require_descriptors() {
  constexpr rlim_t kEnough = 64;
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= kEnough) return;
  throw ConfigError("this process may have " + std::to_string(limit.rlim_cur) +
                    " open files, it needs " + std::to_string(kEnough) + "; set ulimit -n");
}

}  // namespace

std::unique_ptr<lcm::LCM> open_lcm(const std::string& url) {
  require_descriptors();
  auto lcm = std::make_unique<lcm::LCM>(checked_lcm_url(url));
  if (lcm->good()) return lcm;
  throw ConfigError(url +
                    ": LCM could not start. Without a network it needs a multicast route on this "
                    "machine:\n  " +
                    kMulticastRouteCommands);
}

}  // namespace limber
