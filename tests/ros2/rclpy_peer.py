"""A node of ROS 2 (tests/support/ros2_peer.py), run by the Python that has rclpy."""

import json
import sys
import threading

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped, WrenchStamped
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray, String

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
OUT = {
    "/joint_states": (JointState, qos_profile_sensor_data),  # as robot_state_publisher
    "/limber/tip_pose": (PoseStamped, 10),
    "/limber/contact_wrench": (WrenchStamped, 10),
    "/diagnostics": (DiagnosticArray, 10),
    "/robot_description": (String, LATCHED),  # as rviz2
}


def plain(value):
    """A message as JSON has it."""
    if hasattr(value, "get_fields_and_field_types"):
        return {name: plain(getattr(value, name)) for name in value.get_fields_and_field_types()}
    if isinstance(value, bytes):  # a byte
        return value[0]
    if isinstance(value, str | int | float):
        return value
    return [plain(each) for each in value]


def fill(message, given):
    for name, value in given.items():
        if isinstance(value, dict):
            fill(getattr(message, name), value)
        else:
            setattr(message, name, value)
    return message


def say(topic: str, message) -> None:
    with printing:  # from two threads
        print(json.dumps([topic, plain(message)]), flush=True)


rclpy.init()
node = rclpy.create_node("peer")
for name, (kind, qos) in OUT.items():
    node.create_subscription(kind, name, lambda message, name=name: say(name, message), qos)
goals = node.create_publisher(PoseStamped, "/limber/goal_pose", 10)
stiffness = node.create_publisher(Float64MultiArray, "/limber/stiffness", 10)
over, printing = threading.Event(), threading.Lock()


def spin() -> None:
    while not over.is_set():
        rclpy.spin_once(node, timeout_sec=0.05)


thread = threading.Thread(target=spin)
thread.start()
for line in sys.stdin:
    topic, given = json.loads(line)
    if topic == "/limber/goal_pose":
        goals.publish(fill(PoseStamped(), given))
    elif topic == "/limber/stiffness":
        stiffness.publish(Float64MultiArray(data=given))
    elif given == "topics":
        say("?", [f"{name} {' '.join(kinds)}" for name, kinds in node.get_topic_names_and_types()])
    else:
        say("?", node.count_subscribers(given))
over.set()
thread.join()
