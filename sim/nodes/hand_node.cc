#include "sim/nodes/hand_node.h"

#include "common/joints.h"

namespace limber::sim {
namespace {

constexpr unsigned kNoiseSeed = 3 * kMaxMotors;  // beyond those of the joints' encoders

}  // namespace

HandNode::HandNode(const Robot& robot, const JointConfig& drive, int number, const Fingers& fingers)
    : node_(make_motor_node(drive, robot.buses[static_cast<std::size_t>(drive.drive.bus)].fd)),
      bus_(drive.drive.bus),
      number_(number),
      encoder_(drive.motor_encoder, kNoiseSeed) {
  read(fingers);
}

void HandNode::read(const Fingers& fingers) noexcept {
  const MotorPoint at = fingers.point();
  const AngleReading seen = encoder_.reading({at.theta, at.theta_dot});
  reading_.theta = reading_.q = seen.angle;
  reading_.theta_dot = reading_.v = seen.rate;
  reading_.motor_torque = fingers.motor().estimated_torque(at);
  reading_.current_A = fingers.motor().current_A(at);
  reading_.winding_degC = fingers.motor().winding_degC();
}

void HandNode::receive(int bus, const CanFrame& frame, std::int64_t now_ns, BusSide* out) noexcept {
  if (bus != bus_) return;
  CanFrame reply;
  if (node_->receive(frame, reading_, now_ns, &reply)) out->send(number_, reply, now_ns);
  send_pending_of(bus, now_ns, out);
}

void HandNode::send_pending_of(int bus, std::int64_t now_ns, BusSide* out) noexcept {
  if (bus != bus_) return;
  CanFrame frame;
  while (node_->next_frame(&frame)) out->send(number_, frame, now_ns);
}

void HandNode::update(const Fingers& fingers, double h, std::int64_t now_ns,
                      std::vector<BusSide>* buses) noexcept {
  encoder_.update({fingers.theta(), fingers.theta_dot()}, h);
  read(fingers);
  node_->update(reading_, now_ns);
  send_pending_of(bus_, now_ns, &(*buses)[static_cast<std::size_t>(bus_)]);
}

void HandNode::tell(const CanFrame& frame, std::int64_t now_ns) noexcept {
  CanFrame unheard;
  node_->receive(frame, reading_, now_ns, &unheard);
}

}  // namespace limber::sim
