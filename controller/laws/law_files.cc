#include "controller/laws/law_files.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <sstream>

#include "common/config_error.h"
#include "controller/laws/law_plugin.h"

namespace limber::controller {
namespace {

namespace fs = std::filesystem;

constexpr const char* kVariable = "LIMBER_LAWS";

std::vector<std::string> from_environment() {
  const char* given = std::getenv(kVariable);
  std::istringstream words(given == nullptr ? "" : given);
  std::vector<std::string> files;
  for (std::string file; std::getline(words, file, ':');) {
    if (!file.empty()) files.push_back(file);
  }
  return files;
}

/// Whoever can write the file moves the arm.
void check_owner(const std::string& file) {
  struct stat status {};
  if (stat(file.c_str(), &status) != 0 || !S_ISREG(status.st_mode))
    throw ConfigError(file + ": no such file; expected the shared library of a law");
  if (status.st_uid != 0 && status.st_uid != geteuid()) {
    throw ConfigError(
        fmt::format("{}: belongs to user {}; a law is loaded from a file of root or "
                    "of the user who runs it",
                    file, status.st_uid));
  }
  if ((status.st_mode & (S_IWGRP | S_IWOTH)) != 0) {
    throw ConfigError(fmt::format("{}: mode {:o} lets others write it; chmod go-w {}", file,
                                  status.st_mode & 0777U, file));
  }
}

const LawPlugin& opened(const std::string& file) {
  void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr)
    throw ConfigError(fmt::format("{}: cannot be loaded: {}", file, dlerror()));
  const void* symbol = dlsym(library, "limber_law");
  if (symbol == nullptr)
    throw ConfigError(file + ": no law: its source does not end in LIMBER_LAW(...)");
  return *static_cast<const LawPlugin*>(symbol);
}

void check_layout(const std::string& file, const LawPlugin& plugin) {
  const std::string again = "; compile it again with the headers of this limber";
  if (plugin.version != std::string(LIMBER_VERSION)) {
    throw ConfigError(fmt::format("{}: compiled for limber {}, and this is {}{}", file,
                                  plugin.version, LIMBER_VERSION, again));
  }
  for (std::size_t i = 0; i < kLawLayout.size(); ++i) {
    const std::uint64_t theirs = i < plugin.figures ? plugin.layout[i].value : 0;
    if (theirs == kLawLayout[i].value) continue;
    throw ConfigError(fmt::format("{}: {} is {} there and {} here{}", file, kLawLayout[i].what,
                                  theirs, kLawLayout[i].value, again));
  }
}

}  // namespace

std::vector<LawEntry> open_law_files(std::vector<std::string> files) {
  for (std::string& file : from_environment()) files.push_back(std::move(file));
  std::vector<LawEntry> laws;
  std::set<fs::path> seen;
  for (const std::string& file : files) {
    check_owner(file);
    const fs::path path = fs::canonical(file);
    if (!seen.insert(path).second) continue;
    const LawPlugin& plugin = opened(path);
    check_layout(path, plugin);
    laws.push_back(plugin.entry());
    spdlog::info("law {} from {}", laws.back().name, path.string());
  }
  std::ranges::stable_sort(laws, [](const LawEntry& a, const LawEntry& b) {
    return std::string_view(a.name) < std::string_view(b.name);
  });
  return laws;
}

}  // namespace limber::controller
