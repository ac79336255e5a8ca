#include "common/run_lock.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string_view>
#include <utility>

#include "common/config_error.h"

namespace limber {
namespace {

struct Address {
  sockaddr_un name{};
  socklen_t size = 0;
};

/// Abstract: begins with a zero byte and lies in no file system.
Address address_of(std::string_view what) {
  constexpr std::string_view kPrefix = "limber ";
  Address address;
  const std::size_t length = kPrefix.size() + what.size();
  if (length + 1 > sizeof address.name.sun_path)
    throw ConfigError(std::string(what) + ": name too long");
  address.name.sun_family = AF_UNIX;
  char* name = address.name.sun_path + 1;
  std::memcpy(name, kPrefix.data(), kPrefix.size());
  std::memcpy(name + kPrefix.size(), what.data(), what.size());
  address.size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + length);
  return address;
}

int new_socket() {
  const int descriptor = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (descriptor < 0) throw ConfigError(std::string("no Unix socket: ") + std::strerror(errno));
  return descriptor;
}

/// " (process 1234)", "" if it cannot be found out.
std::string holder_of(const Address& address) {
  const int descriptor = new_socket();
  ucred holder{};
  socklen_t size = sizeof holder;
  const bool known =
      connect(descriptor, reinterpret_cast<const sockaddr*>(&address.name), address.size) == 0 &&
      getsockopt(descriptor, SOL_SOCKET, SO_PEERCRED, &holder, &size) == 0 && holder.pid > 0;
  close(descriptor);
  return known ? " (process " + std::to_string(holder.pid) + ")" : "";
}

}  // namespace

RunLock::RunLock(const std::string& what) : socket_(new_socket()) {
  const Address address = address_of(what);
  if (bind(socket_, reinterpret_cast<const sockaddr*>(&address.name), address.size) == 0 &&
      listen(socket_, 1) == 0) {
    return;
  }
  const int error = errno;
  close(socket_);
  if (error != EADDRINUSE) throw ConfigError(what + ": " + std::strerror(error));
  throw ConfigError("there is already a " + what + " on this machine" + holder_of(address) +
                    "; stop it first, or give this one addresses of its own");
}

bool run_lock_free(const char* what) noexcept {
  const int descriptor = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (descriptor < 0) return false;
  const Address address = address_of(what);
  const bool refused =
      connect(descriptor, reinterpret_cast<const sockaddr*>(&address.name), address.size) != 0 &&
      errno == ECONNREFUSED;
  close(descriptor);
  return refused;
}

RunLock::RunLock(RunLock&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}

RunLock::~RunLock() {
  if (socket_ >= 0) close(socket_);
}

}  // namespace limber
