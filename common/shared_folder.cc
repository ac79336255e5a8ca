#include "common/shared_folder.h"

#include <dlfcn.h>

#include <filesystem>

namespace limber {
namespace {

namespace fs = std::filesystem;

/// PREFIX is the nearest folder above `file` that has one.
std::string above(const fs::path& file) {
  std::error_code error;
  fs::path folder = fs::canonical(file, error).parent_path();
  for (; folder.has_relative_path(); folder = folder.parent_path()) {
    const fs::path share = folder / "share" / "limber";
    if (fs::is_directory(share / "robots", error)) return fs::canonical(share, error);
  }
  return "";
}

}  // namespace

std::string shared_folder() {
  const std::string of_program = above("/proc/self/exe");
  if (!of_program.empty()) return of_program;
  Dl_info library{};  // liblimber.so in a program of somebody else's
  const bool found = dladdr(reinterpret_cast<const void*>(&shared_folder), &library) != 0;
  return found ? above(library.dli_fname) : "";
}

}  // namespace limber
