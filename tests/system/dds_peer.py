"""A participant of another process, with types of its own (tests/support/ros2_peer.py)."""

import dataclasses
import json
import sys
import threading
import time

from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import float64, int32, sequence, uint8, uint32
from cyclonedds.internal import InvalidSample
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration


@dataclasses.dataclass
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: int32
    nanosec: uint32


@dataclasses.dataclass
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time
    frame_id: str


@dataclasses.dataclass
class JointState(IdlStruct, typename="sensor_msgs::msg::dds_::JointState_"):
    header: Header
    name: sequence[str]
    position: sequence[float64]
    velocity: sequence[float64]
    effort: sequence[float64]


@dataclasses.dataclass
class Point(IdlStruct, typename="geometry_msgs::msg::dds_::Point_"):
    x: float64
    y: float64
    z: float64


@dataclasses.dataclass
class Quaternion(IdlStruct, typename="geometry_msgs::msg::dds_::Quaternion_"):
    x: float64
    y: float64
    z: float64
    w: float64


@dataclasses.dataclass
class Pose(IdlStruct, typename="geometry_msgs::msg::dds_::Pose_"):
    position: Point
    orientation: Quaternion


@dataclasses.dataclass
class PoseStamped(IdlStruct, typename="geometry_msgs::msg::dds_::PoseStamped_"):
    header: Header
    pose: Pose


@dataclasses.dataclass
class Vector3(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
    x: float64
    y: float64
    z: float64


@dataclasses.dataclass
class Wrench(IdlStruct, typename="geometry_msgs::msg::dds_::Wrench_"):
    force: Vector3
    torque: Vector3


@dataclasses.dataclass
class WrenchStamped(IdlStruct, typename="geometry_msgs::msg::dds_::WrenchStamped_"):
    header: Header
    wrench: Wrench


@dataclasses.dataclass
class KeyValue(IdlStruct, typename="diagnostic_msgs::msg::dds_::KeyValue_"):
    key: str
    value: str


@dataclasses.dataclass
class DiagnosticStatus(IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticStatus_"):
    level: uint8
    name: str
    message: str
    hardware_id: str
    values: sequence[KeyValue]


@dataclasses.dataclass
class DiagnosticArray(IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticArray_"):
    header: Header
    status: sequence[DiagnosticStatus]


@dataclasses.dataclass
class String(IdlStruct, typename="std_msgs::msg::dds_::String_"):
    data: str


@dataclasses.dataclass
class Dimension(IdlStruct, typename="std_msgs::msg::dds_::MultiArrayDimension_"):
    label: str
    size: uint32
    stride: uint32


@dataclasses.dataclass
class Layout(IdlStruct, typename="std_msgs::msg::dds_::MultiArrayLayout_"):
    dim: sequence[Dimension]
    data_offset: uint32


@dataclasses.dataclass
class Numbers(IdlStruct, typename="std_msgs::msg::dds_::Float64MultiArray_"):
    layout: Layout
    data: sequence[float64]


RELIABLE = Policy.Reliability.Reliable(duration(seconds=1))
LATCHED = Qos(RELIABLE, Policy.Durability.TransientLocal, Policy.History.KeepLast(1))
USUAL = Qos(RELIABLE, Policy.History.KeepLast(10))
SENSORS = Qos(Policy.Reliability.BestEffort, Policy.History.KeepLast(5))
OUT = {
    "/joint_states": (JointState, SENSORS),
    "/limber/tip_pose": (PoseStamped, USUAL),
    "/limber/contact_wrench": (WrenchStamped, USUAL),
    "/diagnostics": (DiagnosticArray, USUAL),
    "/robot_description": (String, LATCHED),
}

participant = DomainParticipant(int(sys.argv[1]))
goals = DataWriter(participant, Topic(participant, "rt/limber/goal_pose", PoseStamped), qos=USUAL)
stiffness = DataWriter(participant, Topic(participant, "rt/limber/stiffness", Numbers), qos=USUAL)
readers = {
    name: DataReader(participant, Topic(participant, f"rt{name}", kind), qos=qos)
    for name, (kind, qos) in OUT.items()
}
over, printing = threading.Event(), threading.Lock()


def say(topic: str, message) -> None:
    with printing:  # from two threads
        print(json.dumps([topic, message]), flush=True)


def follow() -> None:
    while not over.is_set():
        for name, reader in readers.items():
            for sample in reader.take(20):
                if not isinstance(sample, InvalidSample):
                    say(name, dataclasses.asdict(sample))
        time.sleep(0.005)


def pose_of(given) -> PoseStamped:
    stamp, frame = given["header"]["stamp"], given["header"]["frame_id"]
    at, turned = given["pose"]["position"], given["pose"]["orientation"]
    pose = Pose(Point(**at), Quaternion(**turned))
    return PoseStamped(Header(Time(**stamp), frame), pose)


thread = threading.Thread(target=follow)
thread.start()
for line in sys.stdin:
    topic, given = json.loads(line)
    if topic == "/limber/goal_pose":
        goals.write(pose_of(given))
    elif topic == "/limber/stiffness":
        stiffness.write(Numbers(Layout([], 0), given))
    else:
        writer = goals if given == "/limber/goal_pose" else stiffness
        say("?", len(writer.get_matched_subscriptions()))
over.set()
thread.join()
