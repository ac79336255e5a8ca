// Memory that processes share under a name in /dev/shm.
#pragma once

#include <cstddef>
#include <string>

#include "common/file_descriptor.h"

namespace limber {

/// Where it lies, and who may have it.
struct SharedPlace {
  std::string what;   ///< as messages call it: "arm plane shm:openarm"
  std::string path;   ///< /dev/shm/...
  std::string group;  ///< whose members may have it; empty: this user alone
};

/// The memory is all 0 when it is new, and outlives all processes, so that each
/// finds it again, whichever was started anew. Set-up only.
class SharedObject {
 public:
  /// Opens the object, or makes it. Throws ConfigError: it is neither this user's nor root's nor of
  /// the place's group; others may write to it; another version of limber made it.
  SharedObject(const SharedPlace& place, std::size_t bytes);
  ~SharedObject();
  SharedObject(const SharedObject&) = delete;
  SharedObject& operator=(const SharedObject&) = delete;

  /// Takes one of its ends until this process ends, however that happens. False: another has it.
  bool take(int end) const;
  void* memory() const noexcept { return memory_; }

 private:
  FileDescriptor file_;
  std::size_t bytes_;
  void* memory_ = nullptr;
};

/// A FIFO beside the object: who reads from it sleeps on it, and is woken by a byte. Never blocks.
/// Throws ConfigError like SharedObject. Set-up only.
FileDescriptor open_shared_fifo(const SharedPlace& place);

}  // namespace limber
