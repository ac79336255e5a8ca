// The words of mode_request_t's REQUEST_*, as users write and read them.
#pragma once

#include <array>

namespace limber {

/// In the order of REQUEST_*.
inline constexpr std::array kModeRequestWords = {"idle", "hold",        "active",
                                                 "stop", "acknowledge", "release"};

}  // namespace limber
