// The driver's exchange with seven drives over a virtual bus, or a vcan interface, beside bare
// sendmmsg and recvmmsg of the same frames, in alternating batches of one run. Both meet a process
// of their own that sends the seven replies as soon as it has the seven commands. Prints one JSON
// line; the figure that travels between machines is the ratio.
//
//   limber-bench-exchange [--rounds 20000] [--vcan] [--rate 1000]
#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/socket.h>
#include <sys/wait.h>

#include <array>
#include <memory>
#include <optional>
#include <stdexcept>
#include <vector>

#include "common/clock.h"
#include "common/config_error.h"
#include "common/latency_histogram.h"
#include "common/multicast_socket.h"
#include "common/program.h"
#include "common/realtime.h"
#include "common/receive_buffer.h"
#include "drivers/can/kernel_frame.h"
#include "drivers/can/memory_bus.h"
#include "drivers/can/virtual_bus.h"
#include "drivers/can/virtual_frame.h"
#include "drivers/processes/wait_for_replies.h"
#include "qa/bench/child_process.h"
#include "sim/simulator.h"

using namespace limber;

namespace {

constexpr int kPriority = 40;

/// The driver's end of its bus. What passes in a cycle is kept while it is in memory.
class SwitchedBus final : public CanBus {
 public:
  explicit SwitchedBus(CanBus* bus) : bus_(bus) {}
  void change_to(CanBus* bus) { bus_ = bus; }

  int send(std::span<const CanFrame> frames) noexcept override {
    if (in_memory()) commands.assign(frames.begin(), frames.end()), replies.clear();
    return bus_->send(frames);
  }
  int receive(std::span<CanFrame> frames) noexcept override {
    const int count = bus_->receive(frames);
    if (in_memory()) replies.insert(replies.end(), frames.begin(), frames.begin() + count);
    return count;
  }
  int descriptor() const noexcept override { return bus_->descriptor(); }
  bool something_waits() const noexcept override { return bus_->something_waits(); }
  void about_to_sleep() noexcept override { bus_->about_to_sleep(); }
  bool polls() const noexcept override { return bus_->polls(); }
  const CanStatistics& statistics() const noexcept override { return bus_->statistics(); }

  std::vector<CanFrame> commands;
  std::vector<CanFrame> replies;

 private:
  bool in_memory() const { return bus_->descriptor() < 0; }
  CanBus* bus_;
};

/// An arm that is held by a driver with the shortest controller there is.
class DrivenArm {
 public:
  explicit DrivenArm(const LoadedRobot& robot)
      : to_driver_(memory_.attach()),
        to_arm_(memory_.attach()),
        bus_(to_driver_.get()),
        driver_(robot.robot, {&bus_}, options()) {
    command_.session = options().session;
    command_.controller = 1;
    command_.num_joints = static_cast<std::int16_t>(robot.robot.size());
    SimulatorOptions still;
    still.lockstep = false;
    Simulator simulator(robot, {to_arm_.get()}, still);
    const auto answer = [&] {
      simulator.poll();
      driver_.poll();
    };
    for (int i = 0; i < 1000; ++i) cycle(answer);
    if (state_->drive_state != joint_state_t::DRIVE_ON)
      throw std::runtime_error("the drives are not on");
  }

  SwitchedBus& bus() { return bus_; }

  /// One exchange over the bus as it is; ns, nothing if a reply came after the driver's window.
  std::optional<std::int64_t> exchange() {
    const std::array<CanBus*, 1> buses{&bus_};
    bool complete = false;
    const std::int64_t taken_ns = cycle([&] {
      const std::int64_t end_ns = monotonic_ns() + driver_.reply_window_ns();
      complete = wait_for_replies(&driver_, buses, end_ns);
    });
    if (!complete) usleep(10'000);  // the replies that are late do not meet the next commands
    if (state_->drive_state != joint_state_t::DRIVE_ON)
      throw std::runtime_error("too many replies came late or never");
    return complete ? std::optional(taken_ns) : std::nullopt;
  }

 private:
  static ArmDriverOptions options() { return {.session = 1, .bridged_cycles = 50}; }

  template <typename Answer>
  std::int64_t cycle(Answer answer) {
    const std::int64_t start_ns = monotonic_ns();
    driver_.transmit(time_ns_, start_ns);
    answer();
    state_ = &driver_.finish_cycle();
    const std::int64_t taken_ns = monotonic_ns() - start_ns;
    time_ns_ += state_->period_ns;
    command_.state_seq = state_->seq;
    command_.time_ns = state_->time_ns;
    command_.request = state_->drive_state == joint_state_t::DRIVE_CONFIGURING
                           ? joint_command_t::REQUEST_KEEP
                           : joint_command_t::REQUEST_ON;
    driver_.accept(command_);
    return taken_ns;
  }

  MemoryBus memory_;
  std::unique_ptr<CanBus> to_driver_;
  std::unique_ptr<CanBus> to_arm_;
  SwitchedBus bus_;
  ArmDriver driver_;
  joint_command_t command_{};
  const joint_state_t* state_ = nullptr;
  std::int64_t time_ns_ = 0;
};

/// A bus by its address in robot.yaml.
struct BusName {
  bool vcan;
  std::string name;
  std::string address() const { return (vcan ? "socketcan:" : "virtual:") + name; }
};

/// An end of a bus that does nothing but the two system calls.
class BareEnd {
 public:
  BareEnd(const BusName& bus, const std::vector<CanFrame>& frames)
      : out_(frames.size()), in_(frames.size()) {
    bus.vcan ? open_vcan(bus.name) : open_virtual(bus.name);
    const int receiver = sockets_.receiver.get();
    fcntl(receiver, F_SETFL, fcntl(receiver, F_GETFL) & ~O_NONBLOCK);
    const timeval patience{1, 0};
    setsockopt(receiver, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      out_.add(i, bus.vcan ? to_kernel(frames[i], out_.datagrams[i])
                           : encode_datagram(frames[i], out_.datagrams[i]));
      if (!bus.vcan) {
        out_.headers[i].msg_hdr.msg_name = &group_;
        out_.headers[i].msg_hdr.msg_namelen = sizeof group_;
      }
      in_.add(i, in_.datagrams[i].size());
    }
  }

  void send() { sendmmsg(sender(), out_.headers.data(), out_.size(), 0); }
  /// Waits for as many as are sent; false after a second without.
  bool receive() {
    for (unsigned have = 0; have < in_.size();) {
      const int count = recvmmsg(sockets_.receiver.get(), &in_.headers[have], in_.size() - have,
                                 MSG_WAITFORONE, nullptr);
      if (count <= 0) return false;
      have += static_cast<unsigned>(count);
    }
    return true;
  }

 private:
  struct Datagrams {
    explicit Datagrams(std::size_t n) : datagrams(n), vectors(n), headers(n) {}
    void add(std::size_t i, std::size_t bytes) {
      vectors[i] = {datagrams[i].data(), bytes};
      headers[i].msg_hdr.msg_iov = &vectors[i];
      headers[i].msg_hdr.msg_iovlen = 1;
    }
    unsigned size() const { return static_cast<unsigned>(headers.size()); }

    std::vector<std::array<std::uint8_t, kLongestEncodedBytes>> datagrams;
    std::vector<iovec> vectors;
    std::vector<mmsghdr> headers;
  };

  void open_virtual(const std::string& name) {
    group_.sin_family = AF_INET;
    group_.sin_port = htons(virtual_bus_port());
    inet_pton(AF_INET, virtual_bus_group(name).c_str(), &group_.sin_addr);
    sockets_ = open_multicast(name, group_, 0, kReceiveBuffer_bytes);
  }
  /// One socket, which does not receive what it sends.
  void open_vcan(const std::string& name) {
    sockets_.receiver = FileDescriptor(socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW));
    const int on = 1;
    setsockopt(sockets_.receiver.get(), SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof on);
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(if_nametoindex(name.c_str()));
    if (address.can_ifindex == 0 ||
        bind(sockets_.receiver.get(), reinterpret_cast<sockaddr*>(&address), sizeof address) != 0)
      throw ConfigError(name + ": there is no such CAN interface; tests/vcan/run-in-vcan has it");
  }
  int sender() const {
    return sockets_.sender.get() >= 0 ? sockets_.sender.get() : sockets_.receiver.get();
  }

  sockaddr_in group_{};
  MulticastSockets sockets_;
  Datagrams out_;
  Datagrams in_;
};

pid_t spawn_drives(const BusName& bus, const std::vector<CanFrame>& replies) {
  return spawn([&] {
    ask_for_realtime(kPriority);
    BareEnd drives(bus, replies);
    while (true) {
      if (drives.receive()) drives.send();
    }
  });
}

std::int64_t bare_exchange(BareEnd* end) {
  const std::int64_t start_ns = monotonic_ns();
  end->send();
  if (!end->receive()) throw std::runtime_error("the bare sockets lost a datagram");
  return monotonic_ns() - start_ns;
}

int run(std::int64_t rounds, bool vcan, double rate_hz) {
  const BusName own{vcan, vcan ? "vcan0" : "bench-own"};
  const BusName peer{vcan, vcan ? "vcan1" : "bench-bare"};
  LoadedRobot robot = load_robot("openarm");
  robot.robot.rate_hz = rate_hz;
  DrivenArm arm(robot);
  const std::vector<CanFrame> commands = arm.bus().commands;
  const std::vector<CanFrame> replies = arm.bus().replies;
  const auto seven = static_cast<std::size_t>(robot.robot.size());
  if (commands.size() != seven || replies.size() != seven)
    throw std::runtime_error("not one command and one reply for each drive");
  const std::array<pid_t, 2> drives{spawn_drives(own, replies), spawn_drives(peer, replies)};
  const std::unique_ptr<CanBus> bus = open_can_bus(own.address(), true);
  arm.bus().change_to(bus.get());
  BareEnd bare(peer, commands);
  const RealtimeGrant grant = ask_for_realtime(kPriority);
  usleep(200'000);  // the drives' sockets are open

  LatencyHistogram own_time;
  LatencyHistogram bare_time;
  constexpr int kBatch = 200;
  std::int64_t late = 0;
  for (std::int64_t done = 0; done < rounds; done += kBatch) {
    for (int i = 0; i < kBatch; ++i) {
      const std::optional<std::int64_t> taken_ns = arm.exchange();
      taken_ns ? own_time.add(*taken_ns) : static_cast<void>(++late);
    }
    for (int i = 0; i < kBatch; ++i) bare_time.add(bare_exchange(&bare));
  }
  for (const pid_t child : drives) kill(child, SIGKILL);
  while (wait(nullptr) > 0) {
  }
  fmt::print(
      "{{\"rounds\": {}, \"late\": {}, \"fifo\": {}, \"own_ns\": {{\"p50\": {}, \"p99\": {}}}, "
      "\"bare_ns\": {{\"p50\": {}, \"p99\": {}}}}}\n",
      rounds, late, grant.fifo, own_time.quantile(0.5), own_time.quantile(0.99),
      bare_time.quantile(0.5), bare_time.quantile(0.99));
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine line("limber-bench-exchange",
                   "The driver's exchange with seven drives beside bare system calls.");
  std::int64_t rounds = 20'000;
  line.integer("--rounds", &rounds, 200, 10'000'000, "exchanges of each kind");
  bool vcan = false;
  line.flag("--vcan", &vcan, "over the interfaces vcan0 and vcan1 instead of virtual buses");
  double rate_hz = 1000.0;
  line.number("--rate", &rate_hz, 1.0, 1000.0, "a reply is late after 0.6 of its period");
  return run_program(line, argc, argv, [&] { return run(rounds, vcan, rate_hz); });
}
