#include "common/open_files.h"

#include <sys/resource.h>

#include <string>

#include "common/config_error.h"

namespace limber {

void require_open_files() {
  constexpr rlim_t kEnough = 64;
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= kEnough) return;
  throw ConfigError("this process may have " + std::to_string(limit.rlim_cur) +
                    " open files, it needs " + std::to_string(kEnough) + "; set ulimit -n");
}

}  // namespace limber
