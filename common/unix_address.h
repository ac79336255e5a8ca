// unix:PATH, the address of an arm plane between two processes only.
#pragma once

#include <string>
#include <string_view>

namespace limber {

inline constexpr std::string_view kUnixScheme = "unix:";

inline bool is_unix_address(const std::string& url) { return url.starts_with(kUnixScheme); }

/// The path of a Unix address.
inline std::string unix_path(const std::string& url) { return url.substr(kUnixScheme.size()); }

}  // namespace limber
