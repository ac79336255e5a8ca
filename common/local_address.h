// Addresses of an arm plane between two processes of this machine only: unix:PATH and
// shm:NAME[?poll][&group=GROUP].
#pragma once

#include <string>
#include <string_view>

namespace limber {

inline constexpr std::string_view kUnixScheme = "unix:";
inline constexpr std::string_view kSharedMemoryScheme = "shm:";

inline bool is_unix_address(const std::string& url) { return url.starts_with(kUnixScheme); }
inline bool is_shared_memory_address(const std::string& url) {
  return url.starts_with(kSharedMemoryScheme);
}

/// The path of a Unix address.
inline std::string unix_path(const std::string& url) { return url.substr(kUnixScheme.size()); }

}  // namespace limber
