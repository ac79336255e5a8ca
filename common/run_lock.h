// What only one process of a machine may do at a time: drive a bus, for example.
#pragma once

#include <string>

namespace limber {

/// Held from construction on; the kernel releases it when the process ends, however that happens.
/// It is a name in the network namespace (an abstract Unix socket), as CAN interfaces and multicast
/// groups are. Set-up only.
class RunLock {
 public:
  /// `what` as in "driver of socketcan:can0", for the error message, too. Throws ConfigError naming
  /// the process that holds it.
  explicit RunLock(const std::string& what);
  ~RunLock();
  RunLock(RunLock&& other) noexcept;
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;
  RunLock& operator=(RunLock&&) = delete;

 private:
  int socket_;
};

/// Nobody holds it. False, too, if that cannot be found out. May be called at any time.
bool run_lock_free(const char* what) noexcept;

}  // namespace limber
