// A link that has gone, and the thread that tries to open it again.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

namespace limber {

/// Ten times a second while the link is gone: to open a device or to look up an interface may wait,
/// or load a module, which the cycle must not. What the link consists of is the thread's from
/// note_gone() until gone() is false.
class ReturnWatch {
 public:
  /// `opened_again`: true once the link is back; called in the thread. Starts it: set-up only. What
  /// it uses has to outlive this watch.
  explicit ReturnWatch(std::function<bool()> opened_again)
      : thread_([this, opened_again = std::move(opened_again)](const std::stop_token& stop) {
          std::mutex mutex;
          std::condition_variable_any wake;
          std::unique_lock lock(mutex);
          while (!stop.stop_requested()) {
            wake.wait_for(lock, stop, kPeriod, [] { return false; });
            if (gone() && !stop.stop_requested() && opened_again())
              gone_.store(false, std::memory_order_release);
          }
        }) {}

  /// In the cycle.
  void note_gone() noexcept { gone_.store(true, std::memory_order_release); }
  /// In the cycle.
  bool gone() const noexcept { return gone_.load(std::memory_order_acquire); }
  /// The thread has ended.
  void stop() {
    thread_.request_stop();
    if (thread_.joinable()) thread_.join();
  }

 private:
  static constexpr std::chrono::milliseconds kPeriod{100};

  std::atomic<bool> gone_ = false;
  std::jthread thread_;
};

}  // namespace limber
