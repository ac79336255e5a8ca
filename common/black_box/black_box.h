// The last seconds of a process, kept where they outlive it.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <thread>

#include "common/black_box/event_ring.h"
#include "common/file_descriptor.h"
#include "common/pace.h"

namespace limber {

/// Memory that is a file in /dev/shm: it survives SIGKILL of the process, not of the machine, and
/// writing to it is no system call. After a fault a copy is kept: a file with what
/// came before and kAfter_s of what came after. What a process that was killed has left is kept by
/// the next one of its name. Copies lie in $LIMBER_BLACK_BOXES, else in limber/black_boxes of
/// $XDG_STATE_HOME or ~/.local/state; the oldest beyond kMostCopies are deleted. `limber log
/// black-box` reads them.
///
/// File: kHeaderBytes of text ("limber-black-box/1", then key: value lines, zeros), then the
/// EventRing, whose times are CLOCK_MONOTONIC.
class BlackBox {
 public:
  static constexpr std::size_t kHeaderBytes = 4096;
  static constexpr double kAfter_s = 2.0;
  static constexpr int kMostCopies = 30;
  static constexpr double kSeconds = 10.0;  ///< before the fault

  /// `name`: program and robot, such as "driver-openarm"; room for kSeconds at `rate_hz`. With
  /// LIMBER_BLACK_BOX=off, or where memory or folder cannot be had (a line in the log), nothing is
  /// kept. Set-up only, before the caller gets real-time priority: a thread starts here.
  BlackBox(const std::string& name, double rate_hz);
  ~BlackBox();
  BlackBox(const BlackBox&) = delete;
  BlackBox& operator=(const BlackBox&) = delete;

  /// An encoded message. From any thread; allowed in the cycle.
  void write(std::string_view channel, std::span<const std::uint8_t> message) noexcept;

  /// Something happened that is worth keeping; `code`, such as driver.VELOCITY, becomes part of the
  /// file's name, which is logged. Nothing happens while a copy is under way. Files are the
  /// thread's work: the caller waits for none. Allocates; not in the cycle.
  void keep(const std::string& code);

 private:
  void open(const std::string& name, std::size_t bytes);
  void keep_when_due();
  std::filesystem::path announce(const std::string& code) const;
  void copy_to(const std::filesystem::path& copy) const;

  std::filesystem::path path_;
  FileDescriptor file_;
  std::span<std::uint8_t> memory_;
  std::optional<EventRing> ring_;

  std::mutex mutex_;  // of what follows
  std::condition_variable changed_;
  std::string code_;  ///< of the copy under way
  bool ending_ = false;
  std::thread thread_;
};

/// None without a clock, where a run can be repeated.
inline std::unique_ptr<BlackBox> open_black_box(const std::string& name, double rate_hz,
                                                Pace pace) {
  return pace == Pace::kLockstep ? nullptr : std::make_unique<BlackBox>(name, rate_hz);
}

inline void keep(BlackBox* box, const std::string& code) {
  if (box != nullptr) box->keep(code);
}

}  // namespace limber
