"""ROS's messages as DDS sends them: fields in the order of the .msg files (common_interfaces),
names of packages and types as ROS's middlewares mangle them. All final, in plain CDR (XCDR 1).
"""

from typing import Any

from cyclonedds.idl import make_idl_struct
from cyclonedds.idl.annotations import final
from cyclonedds.idl.types import float64, int32, sequence, uint8, uint32


def _message(ros_name: str, /, **fields: Any) -> Any:
    package, _, kind = ros_name.partition("/")
    return final(make_idl_struct(kind, f"{package}::msg::dds_::{kind}_", fields))


Doubles = sequence[float64]
xyz = {"x": float64, "y": float64, "z": float64}
Time = _message("builtin_interfaces/Time", sec=int32, nanosec=uint32)
Header = _message("std_msgs/Header", stamp=Time, frame_id=str)
String = _message("std_msgs/String", data=str)

_each = {"position": Doubles, "velocity": Doubles, "effort": Doubles}
JointState = _message("sensor_msgs/JointState", header=Header, name=sequence[str], **_each)

Point = _message("geometry_msgs/Point", **xyz)
Vector3 = _message("geometry_msgs/Vector3", **xyz)
Quaternion = _message("geometry_msgs/Quaternion", **xyz, w=float64)  # limber's order is w, x, y, z
Pose = _message("geometry_msgs/Pose", position=Point, orientation=Quaternion)
PoseStamped = _message("geometry_msgs/PoseStamped", header=Header, pose=Pose)
Wrench = _message("geometry_msgs/Wrench", force=Vector3, torque=Vector3)
WrenchStamped = _message("geometry_msgs/WrenchStamped", header=Header, wrench=Wrench)

OK, WARN, ERROR, STALE = range(4)  # DiagnosticStatus.level
KeyValue = _message("diagnostic_msgs/KeyValue", key=str, value=str)
_words = {"name": str, "message": str, "hardware_id": str}
DiagnosticStatus = _message(
    "diagnostic_msgs/DiagnosticStatus", level=uint8, **_words, values=sequence[KeyValue]
)
DiagnosticArray = _message(
    "diagnostic_msgs/DiagnosticArray", header=Header, status=sequence[DiagnosticStatus]
)

MultiArrayDimension = _message(
    "std_msgs/MultiArrayDimension", label=str, size=uint32, stride=uint32
)
MultiArrayLayout = _message(
    "std_msgs/MultiArrayLayout", dim=sequence[MultiArrayDimension], data_offset=uint32
)
Float64MultiArray = _message("std_msgs/Float64MultiArray", layout=MultiArrayLayout, data=Doubles)
