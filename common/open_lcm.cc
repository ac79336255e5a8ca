#include "common/open_lcm.h"

#include "common/config_error.h"
#include "common/lcm_url.h"
#include "common/multicast_socket.h"
#include "common/open_files.h"

namespace limber {

std::unique_ptr<lcm::LCM> open_lcm(const std::string& url) {
  require_open_files();
  auto lcm = std::make_unique<lcm::LCM>(checked_lcm_url(url));
  if (lcm->good()) return lcm;
  throw ConfigError(url +
                    ": LCM could not start. Without a network it needs a multicast route on this "
                    "machine:\n  " +
                    kMulticastRouteCommands);
}

}  // namespace limber
