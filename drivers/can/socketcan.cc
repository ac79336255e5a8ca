#include "drivers/can/socketcan.h"

#include <linux/can.h>
#include <linux/can/raw.h>
#include <linux/sock_diag.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <vector>

#include "common/config_error.h"
#include "common/receive_buffer.h"
#include "drivers/can/datagram_bus.h"
#include "drivers/can/kernel_frame.h"
#include "drivers/can/return_watch.h"

namespace limber {
namespace {

[[noreturn]] void refuse(const std::string& interface, const std::string& problem) {
  throw ConfigError("socketcan:" + interface + ": " + problem);
}

std::string bring_up(const std::string& interface, bool fd) {
  return "sudo ip link set " + interface + " type can bitrate 1000000" +
         (fd ? " dbitrate 5000000 fd on" : "") + " restart-ms 100 && sudo ip link set " +
         interface + " txqueuelen 64 up";
}

FileDescriptor open_socket(const std::string& interface) {
  FileDescriptor socket(::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW));
  if (socket.get() >= 0) return socket;
  if (errno == EAFNOSUPPORT || errno == EPROTONOSUPPORT) {
    refuse(interface,
           "this kernel has no CAN sockets. Load them (sudo modprobe can_raw) or use a bus that "
           "needs none: virtual:NAME");
  }
  refuse(interface, std::string("cannot open a CAN socket: ") + std::strerror(errno));
}

/// Queries the kernel for a property of an interface; the answer is in `request`.
void query(int socket, unsigned long what, const std::string& interface, ifreq* request) {
  if (ioctl(socket, what, request) == 0) return;
  if (errno != ENODEV) refuse(interface, std::string("cannot be queried: ") + std::strerror(errno));
  refuse(interface,
         "there is no such interface. `ip -br link show type can` lists the adapters; a virtual "
         "one is made with: "
         "sudo ip link add dev " +
             interface + " type vcan && sudo ip link set " + interface + " mtu 72 up");
}

/// The interface's index, once it is known to be fit for use.
int checked_interface(int socket, const std::string& interface, bool fd) {
  ifreq request{};
  if (interface.empty() || interface.size() >= sizeof(request.ifr_name)) {
    refuse(interface, "an interface name has 1 to 15 characters");
  }
  std::memcpy(request.ifr_name, interface.data(), interface.size());
  query(socket, SIOCGIFHWADDR, interface, &request);
  if (request.ifr_hwaddr.sa_family != ARPHRD_CAN) refuse(interface, "is not a CAN interface");
  query(socket, SIOCGIFFLAGS, interface, &request);
  if ((request.ifr_flags & IFF_UP) == 0) {
    refuse(interface, "the interface is down. An adapter: " + bring_up(interface, fd) +
                          "; a virtual interface: sudo ip link set " + interface + " up");
  }
  query(socket, SIOCGIFMTU, interface, &request);
  if (fd && request.ifr_mtu < static_cast<int>(CANFD_MTU)) {
    refuse(interface,
           "the interface carries no CAN-FD, which the robot needs. First sudo ip link set " +
               interface + " down, then an adapter: " + bring_up(interface, fd) +
               "; a virtual interface: sudo ip link set " + interface + " mtu 72 up");
  }
  query(socket, SIOCGIFINDEX, interface, &request);
  return request.ifr_ifindex;
}

FileDescriptor open_bound(const std::string& interface, bool fd) {
  FileDescriptor socket = open_socket(interface);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = checked_interface(socket.get(), interface, fd);
  const int on = 1;
  if (fd && setsockopt(socket.get(), SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof(on)) != 0) {
    refuse(interface, "this kernel has no CAN-FD");
  }
  const can_err_mask_t errors = CAN_ERR_MASK;
  setsockopt(socket.get(), SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof(errors));
  set_receive_buffer(socket.get(), kReceiveBuffer_bytes);
  prepare_receive(socket.get());
  if (bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    refuse(interface, std::string("cannot bind: ") + std::strerror(errno));
  }
  return socket;
}

/// The interface is gone; a socket that was bound to it is bound to none (ENXIO).
bool is_gone_error(int error) noexcept { return error == ENODEV || error == ENXIO; }
bool is_link_error(int error) noexcept { return error == ENETDOWN || is_gone_error(error); }

can_filter to_kernel(const CanFilter& filter) noexcept {
  return {filter.id | (filter.extended ? CAN_EFF_FLAG : 0U), filter.mask | CAN_EFF_FLAG};
}

/// Bytes that this socket has sent and that no adapter has taken yet.
std::uint32_t queued_bytes(int socket) noexcept {
  std::array<std::uint32_t, SK_MEMINFO_VARS> memory{};
  socklen_t size = sizeof(memory);
  if (getsockopt(socket, SOL_SOCKET, SO_MEMINFO, memory.data(), &size) != 0) return 0;
  return memory[SK_MEMINFO_WMEM_ALLOC];
}

class SocketCanBus final : public DatagramBus {
 public:
  SocketCanBus(const std::string& interface, bool fd)
      : DatagramBus(fd, Stamps::kOnArrival, CANFD_MTU, CANFD_MTU), interface_(interface) {
    receiver_ = open_bound(interface, fd);
  }

  void set_receive_filters(std::span<const CanFilter> filters) override {
    const std::lock_guard lock(filters_mutex_);
    filters_.clear();
    for (const CanFilter& filter : filters) filters_.push_back(to_kernel(filter));
    if (!apply_filters())
      refuse(interface_, std::string("cannot set the receive filters: ") + std::strerror(errno));
  }

 private:
  bool apply_filters() noexcept {
    const std::size_t bytes = filters_.size() * sizeof(can_filter);
    return setsockopt(receiver_.get(), SOL_CAN_RAW, CAN_RAW_FILTER, filters_.data(),
                      static_cast<socklen_t>(bytes)) == 0;
  }

  /// The socket stays, with its descriptor and options; when an interface goes the kernel unbinds
  /// it and drops its filters.
  bool bind_again() noexcept {
    try {
      sockaddr_can address{};
      address.can_family = AF_CAN;
      address.can_ifindex = checked_interface(receiver_.get(), interface_, fd_);
      const std::lock_guard lock(filters_mutex_);
      return apply_filters() && bind(receiver_.get(), reinterpret_cast<const sockaddr*>(&address),
                                     sizeof(address)) == 0;
    } catch (const ConfigError&) {
      return false;  // not there yet, or still down
    }
  }

  void note_sending() noexcept override { statistics_.unsent = queued_bytes(receiver_.get()) > 0; }

  std::size_t encode(const CanFrame& frame, std::span<std::uint8_t> out) const noexcept override {
    return to_kernel(frame, out);
  }
  bool decode(std::span<const std::uint8_t> datagram, CanFrame* frame) const noexcept override {
    return from_kernel(datagram, frame);
  }

  void note_sent(int sent, int wanted) noexcept override {
    if (sent < wanted) note_error();
    if (sent == wanted) statistics_.link_down = false;
  }

  /// The kernel reports a lost link once, perhaps late, before the frames that wait behind the
  /// report.
  bool note_receive_error() noexcept override { return note_error(); }

  /// Keeps errno; true if it is the link's.
  bool note_error() noexcept {
    statistics_.last_errno = errno;
    if (is_gone_error(errno)) watch_.note_gone();
    if (!is_link_error(errno)) return false;
    statistics_.link_down = true;
    statistics_.bus_off = false;  // a controller that was stopped starts afresh
    return true;
  }

  bool note_received(const CanFrame& /*frame*/) noexcept override {
    statistics_.link_down = false;
    return true;
  }

  std::string interface_;
  std::mutex filters_mutex_;
  std::vector<can_filter> filters_ = {can_filter{0, 0}};  ///< all
  ReturnWatch watch_{[this] { return bind_again(); }};    ///< last: it ends before what it uses
};

}  // namespace

std::unique_ptr<CanBus> open_socketcan(const std::string& interface, bool fd) {
  return std::make_unique<SocketCanBus>(interface, fd);
}

}  // namespace limber
