#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>

#include "common/arm_plane/datagram_port.h"
#include "common/config_error.h"
#include "common/file_descriptor.h"
#include "common/local_address.h"
#include "common/run_lock.h"
#include "common/wait_readable.h"

namespace limber {
namespace {

[[noreturn]] void refuse_path(const std::string& path, const std::string& problem) {
  throw ConfigError("arm plane unix:" + path + ": " + problem);
}

const char* suffix(ArmPlaneEnd end) {
  return end == ArmPlaneEnd::kDriver ? ".driver" : ".controller";
}

sockaddr_un address_of(const std::string& path, ArmPlaneEnd end) {
  const std::string name = path + suffix(end);
  sockaddr_un address{};
  if (name.size() >= sizeof address.sun_path) refuse_path(path, "longer than 96 characters");
  address.sun_family = AF_UNIX;
  name.copy(address.sun_path, name.size());
  return address;
}

/// The group whose members may send here.
gid_t group_of_folder(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path();
  struct stat details {};
  if (!path.starts_with('/'))
    refuse_path(path, "not an absolute path, such as unix:/run/limber/arm");
  if (stat(folder.c_str(), &details) != 0) refuse_path(path, folder + ": " + std::strerror(errno));
  if ((details.st_mode & S_IWOTH) != 0) {
    refuse_path(path, folder +
                          " is writable for everybody, who could take the place of driver or "
                          "controller; use a folder of your own");
  }
  return details.st_gid;
}

class UnixPort final : public DatagramPort {
 public:
  UnixPort(const std::string& path, ArmPlaneEnd end)
      : group_(group_of_folder(path)),
        own_(address_of(path, end)),
        peer_(address_of(
            path, end == ArmPlaneEnd::kDriver ? ArmPlaneEnd::kController : ArmPlaneEnd::kDriver)),
        lock_(std::string("process at unix:") + own_.sun_path),
        socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
    const int on = 1;
    // What a process that was killed has left behind: nobody has it, since the lock was free.
    unlink(own_.sun_path);
    if (setsockopt(socket_.get(), SOL_SOCKET, SO_PASSCRED, &on, sizeof on) != 0 ||
        bind(socket_.get(), reinterpret_cast<const sockaddr*>(&own_), sizeof own_) != 0 ||
        chmod(own_.sun_path, S_IRUSR | S_IWUSR | S_IRGRP | S_IWGRP) != 0)
      refuse_path(path, std::string(own_.sun_path) + ": " + std::strerror(errno));
  }
  ~UnixPort() override { unlink(own_.sun_path); }

  bool send(std::span<const std::uint8_t> datagram) noexcept override {
    const auto sent = sendto(socket_.get(), datagram.data(), datagram.size(), 0,
                             reinterpret_cast<const sockaddr*>(&peer_), sizeof peer_);
    return sent == static_cast<ssize_t>(datagram.size());
  }

  int receive(std::span<std::uint8_t> room) noexcept override {
    while (true) {
      iovec data{room.data(), room.size()};
      alignas(cmsghdr) std::array<std::byte, CMSG_SPACE(sizeof(ucred))> control{};
      msghdr message{};
      message.msg_iov = &data;
      message.msg_iovlen = 1;
      message.msg_control = control.data();
      message.msg_controllen = control.size();
      const auto size = recvmsg(socket_.get(), &message, MSG_TRUNC);
      if (size < 0 || may_send(sender_of(message))) return static_cast<int>(size);
      ++dropped_;
    }
  }
  bool wait(std::int64_t deadline_ns) noexcept override {
    return wait_readable(socket_.get(), deadline_ns);
  }
  std::int64_t dropped() const noexcept override { return dropped_; }

 private:
  static std::optional<ucred> sender_of(msghdr& message) noexcept {
    const cmsghdr* item = CMSG_FIRSTHDR(&message);
    if (item == nullptr || item->cmsg_type != SCM_CREDENTIALS) return std::nullopt;
    ucred sender{};
    std::memcpy(&sender, CMSG_DATA(item), sizeof sender);
    return sender;
  }
  bool may_send(const std::optional<ucred>& sender) const noexcept {
    return sender && (sender->uid == 0 || sender->uid == user_ || sender->gid == group_);
  }

  gid_t group_;
  uid_t user_ = geteuid();
  sockaddr_un own_;
  sockaddr_un peer_;
  RunLock lock_;
  FileDescriptor socket_;
  std::int64_t dropped_ = 0;
};

}  // namespace

std::unique_ptr<DatagramPort> open_unix_port(const std::string& url, ArmPlaneEnd end) {
  return std::make_unique<UnixPort>(unix_path(url), end);
}

}  // namespace limber
