"""What a message's numbers are called in other formats: `joints.elbow.q_rad`, `p_BT.x_m`.

Messages have arrays over joints, axes and buses; tables and plots want one name a number, with its
unit. Here alone is decided what that name is.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import Any

from limber import messages

JOINT_UNITS = {
    "q": "rad",
    "v": "rad_per_s",
    "theta": "rad",
    "theta_dot": "rad_per_s",
    "preload": "rad",
    "preload_dot": "rad_per_s",
    "sigma": "Nm_per_rad",
    "K_q": "Nm_per_rad",
    "D_q": "Nms_per_rad",
    "K_null": "Nm_per_rad",
    "D_null": "Nms_per_rad",
}
POSITION = ("x_m", "y_m", "z_m")
DIRECTION = ("x", "y", "z")
QUATERNION = ("w", "x", "y", "z")
DISPLACEMENT = (*POSITION, "rx_rad", "ry_rad", "rz_rad")
TWIST = ("x_m_per_s", "y_m_per_s", "z_m_per_s", "rx_rad_per_s", "ry_rad_per_s", "rz_rad_per_s")
WRENCH = ("fx_N", "fy_N", "fz_N", "mx_Nm", "my_Nm", "mz_Nm")
VECTORS = {
    **dict.fromkeys(("p_BT", "p_BD", "p_BO", "point", "peg", "size", "payload_position"), POSITION),
    **dict.fromkeys(("quat_BT", "quat_BD"), QUATERNION),
    **dict.fromkeys(("e", "offset"), DISPLACEMENT),
    **dict.fromkeys(
        ("F_law", "F_ext", "F_sensor", "F_contact", "F_push", "F_ff", "wrench"), WRENCH
    ),
    "V_BT": TWIST,
    "v_BO": TWIST,
    "normal": DIRECTION,
}
# Their unit is not in the field's name
SCALARS = {"yaw": "yaw_rad", "yaw_rate": "yaw_rate_rad_per_s"}
# Units of a six-by-six matrix: translation, coupling, rotation
MATRICES = {
    "K_x": ("N_per_m", "N_per_rad", "Nm_per_rad"),
    "D_x": ("Ns_per_m", "Ns_per_rad", "Nms_per_rad"),
    "M_x": ("kg", "kg_m", "kg_m2"),
}
# Arrays whose index is a constant of a message: type and prefix
INDEXED = {
    "commands_refused": ("driver_status_t", "VERDICT_"),
    "term_period_cycles": ("compliance_gains_t", "PERIOD_"),
    "period_cycles": ("compliance_gains_t", "PERIOD_"),
}
NOT_JOINTS = ("commands_refused",)
NUM_JOINTS = 16  # room in messages
KNOTS = ("dt_s", "value", "hand_width_m")  # of target_stream_t
# Numbers that stand for words: (message, field) -> type and prefix of the constants
WORDS = {
    ("joint_state_t", "drive_state"): ("joint_state_t", "DRIVE_"),
    ("joint_state_t", "fault"): ("joint_state_t", "FAULT_"),
    ("joint_state_t", "sensor_state"): ("joint_state_t", "SENSOR_"),
    ("joint_state_t", "emergency_stop"): ("joint_state_t", "STOP_"),
    ("driver_status_t", "drive_state"): ("joint_state_t", "DRIVE_"),
    ("driver_status_t", "fault"): ("joint_state_t", "FAULT_"),
    ("joint_command_t", "request"): ("joint_command_t", "REQUEST_"),
    ("joint_command_t", "mode"): ("controller_status_t", "MODE_"),
    ("controller_status_t", "mode"): ("controller_status_t", "MODE_"),
    ("controller_status_t", "reason"): ("controller_status_t", "REASON_"),
    ("controller_status_t", "contact"): ("compliance_gains_t", "CONTACT_"),
    ("mode_request_t", "request"): ("mode_request_t", "REQUEST_"),
    ("compliance_goal_t", "kind"): ("compliance_goal_t", "GOAL_"),
    ("controller_status_t", "stream"): ("controller_status_t", "STREAM_"),
    ("target_stream_t", "kind"): ("target_stream_t", "KIND_"),
    ("scenario_event_t", "kind"): ("scenario_event_t", "EVENT_"),
    ("scenario_event_t", "fault"): ("scenario_event_t", "FAULT_"),
}


@dataclass(frozen=True)
class Column:
    """One number of a message. `words`: type and prefix of the constants that it is one of."""

    path: tuple[str, ...]
    field: str
    index: tuple[int, ...]
    words: tuple[str, str] | None

    @property
    def name(self) -> str:
        return ".".join(self.path)


@cache
def columns(type_name: str, joints: tuple[str, ...]) -> list[Column]:
    """Of a message of fixed size; what belongs to joints that the arm does not have is left out."""
    cls = messages.message_class(type_name)
    found = []
    for field, shape in zip(cls.__slots__, cls.__dimensions__, strict=True):
        words = WORDS.get((type_name, field))
        found += [
            Column(path, field, index, words)
            for path, index in _places(field, tuple(shape or ()), joints)
        ]
    return found


def as_object(message: Any, joints: tuple[str, ...]) -> dict[str, Any]:
    """A message of any type, with the same names, as nested dictionaries."""
    made: dict[str, Any] = {}
    for field, shape in zip(message.__slots__, message.__dimensions__, strict=True):
        value = getattr(message, field)
        if shape is None:
            made[field] = value
        elif any(isinstance(size, str) for size in shape):
            made[field] = [as_object(v, joints) if hasattr(v, "__slots__") else v for v in value]
        else:
            for path, index in _places(field, tuple(shape), joints):
                _put(made, path, _at(value, index))
    return made


def _places(
    field: str, shape: tuple[int, ...], joints: tuple[str, ...]
) -> Iterator[tuple[tuple[str, ...], tuple[int, ...]]]:
    """Path and index of every number in a field."""
    if not shape:
        yield (SCALARS.get(field, field),), ()
    elif field in KNOTS:
        for index in product(*map(range, shape)):
            yield ("knots", *(str(i + 1) for i in index), field), index
    elif shape == (NUM_JOINTS,) and field not in NOT_JOINTS:
        unit = "Nm" if field.startswith("tau") else JOINT_UNITS.get(field, "")
        name = f"{field}_{unit}" if unit else field
        for i, joint in enumerate(joints):
            yield ("joints", joint, name), (i,)
    elif field in MATRICES:
        for row, column in product(range(6), repeat=2):
            unit = MATRICES[field][row // 3 + column // 3]
            yield (field, f"{_axis(row)}_{_axis(column)}_{unit}"), (row, column)
    elif field == "p_BO" and len(shape) == 2:
        for i, axis in product(range(shape[0]), range(3)):
            yield (field, f"object{i + 1}", POSITION[axis]), (i, axis)
    elif field in INDEXED:
        for i, word in messages.constants(*INDEXED[field]).items():
            yield (field, word.lower()), (i,)
    else:
        single = {"law_outputs": "output", "object_flags": "object"}.get(field, "bus")
        labels = VECTORS.get(field, ())[: shape[0]] or [f"{single}{i + 1}" for i in range(shape[0])]
        for i, label in enumerate(labels):
            yield (field, label), (i,)


def _axis(i: int) -> str:
    return ("x", "y", "z", "rx", "ry", "rz")[i]


def _at(value: Any, index: tuple[int, ...]) -> Any:
    for i in index:
        value = value[i]
    return value


def _put(made: dict[str, Any], path: tuple[str, ...], value: Any) -> None:
    for name in path[:-1]:
        made = made.setdefault(name, {})
    made[path[-1]] = value
