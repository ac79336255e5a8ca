#include "drivers/can/serial_port.h"

#include <fcntl.h>
#include <linux/serial.h>
#include <sys/ioctl.h>
#include <termios.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "common/config_error.h"

namespace limber {
namespace {

constexpr std::array<std::pair<int, speed_t>, 9> kBaudRates = {{{115'200, B115200},
                                                                {230'400, B230400},
                                                                {460'800, B460800},
                                                                {500'000, B500000},
                                                                {921'600, B921600},
                                                                {1'000'000, B1000000},
                                                                {1'500'000, B1500000},
                                                                {2'000'000, B2000000},
                                                                {3'000'000, B3000000}}};

std::string cure() {
  switch (errno) {
    case ENOENT:
      return "there is no such device: is the adapter plugged in? `ls /dev/serial/by-id` lists "
             "serial adapters by names that stay";
    case EACCES:
      return "no permission: sudo usermod -aG dialout $USER, then log in again";
    case EBUSY:
      return "another program uses it: end that one";
    default:
      return std::string("cannot be opened: ") + std::strerror(errno);
  }
}

/// Serial chips on USB collect bytes for up to 16 ms otherwise.
void request_low_latency(int port) noexcept {
  serial_struct settings{};
  if (ioctl(port, TIOCGSERIAL, &settings) != 0) return;
  settings.flags |= ASYNC_LOW_LATENCY;
  ioctl(port, TIOCSSERIAL, &settings);
}

}  // namespace

FileDescriptor open_serial_port(const std::string& address, const std::string& path, int baud) {
  const auto refuse = [&](const std::string& problem) {
    throw ConfigError(address + ": " + problem);
  };
  const auto* const rate = std::ranges::find(kBaudRates, baud, &std::pair<int, speed_t>::first);
  if (rate == kBaudRates.end())
    refuse(std::to_string(baud) +
           " is no usual rate: 115200, 230400, 460800, 500000, 921600, "
           "1000000, 1500000, 2000000 or 3000000");
  FileDescriptor port(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (port.get() < 0) refuse(cure());
  termios settings{};
  if (tcgetattr(port.get(), &settings) != 0) refuse("is no serial line");
  if (ioctl(port.get(), TIOCEXCL) != 0) refuse(cure());
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS);
  settings.c_cc[VMIN] = 1;  // nothing to read is EAGAIN then, and 0 that the line is gone
  settings.c_cc[VTIME] = 0;
  cfsetspeed(&settings, rate->second);
  if (tcsetattr(port.get(), TCSANOW, &settings) != 0)
    refuse(std::string("cannot be set up: ") + std::strerror(errno));
  request_low_latency(port.get());
  tcflush(port.get(), TCIOFLUSH);
  return port;
}

}  // namespace limber
