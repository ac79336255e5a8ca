#include "tests/drivers/can/private_network.h"

#include <arpa/inet.h>
#include <net/if.h>
#include <net/route.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>

namespace limber::testing {
namespace {

bool raise_loopback(int socket) {
  ifreq request{};
  std::strcpy(request.ifr_name, "lo");
  request.ifr_flags = IFF_UP | IFF_RUNNING | IFF_LOOPBACK | IFF_MULTICAST;
  return ioctl(socket, SIOCSIFFLAGS, &request) == 0;
}

sockaddr ipv4(const char* text) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  inet_pton(AF_INET, text, &address.sin_addr);
  sockaddr generic{};
  std::memcpy(&generic, &address, sizeof(address));
  return generic;
}

bool add_multicast_route(int socket) {
  char device[] = "lo";
  rtentry route{};
  route.rt_dst = ipv4("224.0.0.0");
  route.rt_genmask = ipv4("240.0.0.0");
  route.rt_flags = RTF_UP;
  route.rt_dev = device;
  return ioctl(socket, SIOCADDRT, &route) == 0;
}

bool try_to_enter(bool multicast_route) {
  if (unshare(CLONE_NEWNET) != 0 && unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) return false;
  const int socket = ::socket(AF_INET, SOCK_DGRAM, 0);
  const bool done = raise_loopback(socket) && (!multicast_route || add_multicast_route(socket));
  close(socket);
  return done;
}

}  // namespace

bool enter_private_network(bool multicast_route) {
  // Some systems allow the namespace and then refuse everything in it, so a child tries first.
  const pid_t child = fork();
  if (child == 0) _exit(try_to_enter(multicast_route) ? EXIT_SUCCESS : EXIT_FAILURE);
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child || status != EXIT_SUCCESS) return false;
  return try_to_enter(multicast_route);
}

}  // namespace limber::testing
