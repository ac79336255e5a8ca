// The LCM library, for those who listen to everything; LcmPort speaks its wire format without it.
#pragma once

#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <string>

namespace limber {

/// Opens `url`, see checked_lcm_url(). Throws ConfigError: too few descriptors (LCM would end the
/// process), no multicast route. Set-up only.
std::unique_ptr<lcm::LCM> open_lcm(const std::string& url);

}  // namespace limber
