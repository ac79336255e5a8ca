#include "common/black_box/black_box.h"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <system_error>
#include <vector>

#include "common/clock.h"
#include "common/tell.h"
#include "common/wall_clock.h"

namespace limber {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kFormat = "limber-black-box/1";

std::string from_environment(const char* variable) {
  const char* value = std::getenv(variable);
  return value == nullptr ? "" : value;
}

fs::path copies_folder() {
  if (const std::string own = from_environment("LIMBER_BLACK_BOXES"); !own.empty()) return own;
  const std::string state = from_environment("XDG_STATE_HOME");
  const fs::path base =
      state.empty() ? fs::path(from_environment("HOME")) / ".local" / "state" : fs::path(state);
  return base / "limber" / "black_boxes";
}

/// In order of time by name.
std::string now_text() {
  return fmt::format(
      "{:%Y%m%dT%H%M%S}",
      fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
}

/// A folder that this user alone may change.
fs::path boxes_folder() {
  const fs::path folder = fmt::format("/dev/shm/limber-{}", geteuid());
  fs::create_directories(folder);
  fs::permissions(folder, fs::perms::owner_all);
  return folder;
}

[[noreturn]] void fail(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

void delete_oldest(const fs::path& folder) {
  std::vector<fs::path> copies;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".box") copies.push_back(entry.path());
  std::ranges::sort(copies);
  constexpr auto kept = static_cast<std::size_t>(BlackBox::kMostCopies) - 1;  // one is to come
  for (std::size_t i = 0; i + kept < copies.size(); ++i) fs::remove(copies[i]);
}

/// A state and a command a cycle, and what else there is.
std::size_t bytes_for(double rate_hz) {
  constexpr double kPerCycle = 2300.0;
  constexpr double kLeast = 1 << 20;
  constexpr double kMost = 64 << 20;
  const double seconds = BlackBox::kSeconds + BlackBox::kAfter_s;
  return static_cast<std::size_t>(std::clamp(rate_hz * seconds * kPerCycle, kLeast, kMost)) / 8 * 8;
}

fs::path copy_path(const std::string& name, const std::string& code) {
  const fs::path folder = copies_folder();
  fs::create_directories(folder);
  const fs::path path = folder / fmt::format("{}-{}-{}.box", now_text(), name, code);
  delete_oldest(folder);
  return path;
}

}  // namespace

BlackBox::BlackBox(const std::string& name, double rate_hz) {
  if (from_environment("LIMBER_BLACK_BOX") == "off") return;
  try {
    open(name, bytes_for(rate_hz));
    thread_ = std::thread([this] { keep_when_due(); });
  } catch (const std::exception& error) {
    spdlog::warn("no black box: {}; after a fault nothing will be kept", error.what());
    ring_.reset();
  }
}

void BlackBox::open(const std::string& name, std::size_t bytes) {
  const fs::path folder = boxes_folder();
  // A live process of the same name, of another network for example, holds the lock of its file.
  for (int i = 1; path_.empty(); ++i) {
    const fs::path path = folder / (i == 1 ? name : fmt::format("{}~{}", name, i));
    file_ = FileDescriptor(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
    if (file_.get() < 0) fail(path);
    if (flock(file_.get(), LOCK_EX | LOCK_NB) == 0) path_ = path;
  }
  if (fs::file_size(path_) > 0) {  // its process did not end by itself
    const fs::path copy = copy_path(path_.filename(), "killed");
    fs::copy_file(path_, copy, fs::copy_options::overwrite_existing);
    spdlog::warn("warning: the last {} ended without closing its black box; kept: {}", name,
                 copy.string());
    if (ftruncate(file_.get(), 0) != 0) fail(path_);
  }
  const std::size_t size = kHeaderBytes + bytes;
  if (const int error = posix_fallocate(file_.get(), 0, static_cast<off_t>(size)); error != 0)
    throw std::system_error(error, std::generic_category(), path_);
  void* memory =
      mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, file_.get(), 0);
  if (memory == MAP_FAILED) fail(path_);
  memory_ = {static_cast<std::uint8_t*>(memory), size};
  const std::string header =
      fmt::format("{}\nname: {}\nprocess: {}\nepoch_minus_monotonic_ns: {}\n", kFormat, name,
                  getpid(), epoch_minus_monotonic_ns());
  header.copy(reinterpret_cast<char*>(memory), kHeaderBytes - 1);
  ring_.emplace(memory_.subspan(kHeaderBytes));
}

BlackBox::~BlackBox() {
  if (thread_.joinable()) {
    {
      const std::lock_guard lock(mutex_);
      ending_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }
  if (!memory_.empty()) munmap(memory_.data(), memory_.size());
  if (!path_.empty()) unlink(path_.c_str());
}

void BlackBox::write(std::string_view channel, std::span<const std::uint8_t> message) noexcept {
  if (ring_) ring_->write(channel, monotonic_ns() / 1000, message);
}

void BlackBox::keep(const std::string& code) {
  if (!ring_) return;
  const std::lock_guard lock(mutex_);
  if (!code_.empty()) return;
  code_ = code;
  changed_.notify_all();
}

fs::path BlackBox::announce(const std::string& code) const {
  try {
    const fs::path copy = copy_path(path_.filename(), code);
    spdlog::info("what happened is kept for `limber log black-box`: {}", copy.string());
    return copy;
  } catch (const std::exception& error) {
    spdlog::warn("the black box cannot be kept: {}", error.what());
    return {};
  }
}

void BlackBox::keep_when_due() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ending_ || !code_.empty(); });
    if (!code_.empty()) {
      lock.unlock();
      const fs::path copy = announce(code_);  // which keep() leaves alone until it is cleared
      lock.lock();
      changed_.wait_for(lock, std::chrono::duration<double>(kAfter_s), [this] { return ending_; });
      lock.unlock();
      if (!copy.empty()) tell([&] { copy_to(copy); });
      lock.lock();
      code_.clear();
    }
    if (ending_) return;
  }
}

void BlackBox::copy_to(const fs::path& copy) const {
  std::ofstream out(copy, std::ios::binary);
  out.write(reinterpret_cast<const char*>(memory_.data()),
            static_cast<std::streamsize>(memory_.size()));
  out.close();
  if (!out) spdlog::warn("the black box could not be written to {}", copy.string());
}

}  // namespace limber
