"""What a running arm is doing, in SI units, read off its two messages."""

from dataclasses import dataclass

import numpy as np

from limber.errors import InputError
from limber.messages import HAND, bit_names, constants
from limber.model.gains_table import law_names
from limber.model.rotations import between, matrix_of
from limber.problems import problem, problems_of_bits, sentence


@dataclass(frozen=True, eq=False)
class Pose:
    """A pose in the base frame.

    `p`: position, m, shape (3,); `quat`: unit quaternion w, x, y, z, shape (4,).
    """

    p: np.ndarray
    quat: np.ndarray

    @property
    def R(self) -> np.ndarray:
        """Rotation matrix, shape (3, 3)."""
        return matrix_of(self.quat)

    def distance(self, other: "Pose") -> tuple[float, float]:
        """Distance of the positions, m, and angle of the rotation between them, rad."""
        angle = np.linalg.norm(between(self.quat, other.quat))
        return float(np.linalg.norm(self.p - other.p)), float(angle)


TARGET_COUNTS = ("taken", "late", "stale", "refused", "starved")


@dataclass(frozen=True)
class Targets:
    """`state`: none, running, or waiting (at rest, or coming to it, until more targets come);
    `delay_s` of its newest message, `margin_s` from now to its last target, negative if that has
    passed. Messages since the controller's start: taken, of these those whose targets had all
    passed (late), dropped as too old or out of order (stale), refused; how often targets ran out
    (starved).
    """

    state: str
    delay_s: float
    margin_s: float
    taken: int
    late: int
    stale: int
    refused: int
    starved: int

    def __str__(self) -> str:
        counts = ", ".join(f"{getattr(self, name)} {name}" for name in TARGET_COUNTS)
        margin = "" if self.state == "none" else f", margin {1e3 * self.margin_s:+.0f} ms"
        return f"targets {self.state}{margin}: {counts}"


def targets_of(status: np.void) -> Targets:
    """Of a CONTROLLER_STATUS."""
    state = constants("controller_status_t", "STREAM_")[int(status["stream"])].lower()
    delay_s, margin_s = (float(status[f"stream_{name}_s"]) for name in ("delay", "margin"))
    counts = {name: int(status[f"stream_{name}"]) for name in TARGET_COUNTS}
    return Targets(state, delay_s, margin_s, **counts)


class Quantities:
    """The quantities of an arm at one time.

    Joint quantities have one entry a joint, in the order of robot.yaml: rad, rad/s and N m, or m,
    m/s and N for prismatic joints. Six-vectors are [linear; angular] in base axes.
    """

    def _records(self) -> tuple[np.void, np.void]:
        """JOINT_STATE and CONTROLLER_STATUS."""
        raise NotImplementedError

    def _joint_names(self) -> tuple[str, ...]:
        raise NotImplementedError

    def _joint(self, field: str, of_status: bool = False) -> np.ndarray:
        record = self._records()[of_status]
        return np.array(record[field][: int(record["num_joints"])], float)

    def _pose(self, frame: str) -> Pose:
        status = self._records()[1]
        return Pose(np.array(status[f"p_{frame}"]), np.array(status[f"quat_{frame}"]))

    @property
    def time_s(self) -> float:
        """Arm time, s: since the driver's first cycle."""
        return float(self._records()[0]["time_ns"]) * 1e-9

    @property
    def q(self) -> np.ndarray:
        """Joint positions, rad or m."""
        return self._joint("q")

    @property
    def v(self) -> np.ndarray:
        """Joint velocities, rad/s or m/s."""
        return self._joint("v")

    @property
    def tau(self) -> np.ndarray:
        """Joint torques as measured, N m or N."""
        return self._joint("tau")

    @property
    def pose(self) -> Pose:
        """Pose of the tip."""
        return self._pose("BT")

    @property
    def twist(self) -> np.ndarray:
        """Velocity of the tip, m/s and rad/s, shape (6,)."""
        return np.array(self._records()[1]["V_BT"])

    @property
    def goal(self) -> Pose:
        """Desired pose of the tip: the equilibrium of the virtual spring."""
        return self._pose("BD")

    @property
    def error(self) -> np.ndarray:
        """Pose error, actual minus desired, m and rad, shape (6,)."""
        return np.array(self._records()[1]["e"])

    @property
    def wrench(self) -> np.ndarray:
        """Estimated contact: wrench of the world on the arm at the tip, N and N m, shape (6,).
        InputError while the gains choose no contact source.
        """
        return np.array(self._contact()["F_ext"])

    @property
    def contact_torque(self) -> np.ndarray:
        """The same at the joints, N m or N."""
        self._contact()
        return self._joint("tau_ext", of_status=True)

    def _contact(self) -> np.void:
        status = self._records()[1]
        if not status["contact"]:
            raise InputError(
                "no contact source is chosen, so contact is unknown: "
                'arm.gains(contact="joint_torque"), or "tip_sensor" if the arm has one'
            )
        return status

    @property
    def mode(self) -> str:
        """boot, init, idle, hold, active, soft_stop, fault or estop."""
        return constants("controller_status_t", "MODE_")[int(self._records()[1]["mode"])].lower()

    @property
    def drives(self) -> str:
        """configuring, off, enabling, on, hold, damp or fault."""
        states = constants("joint_state_t", "DRIVE_")
        return states[int(self._records()[0]["drive_state"])].lower()

    @property
    def law(self) -> str:
        """Name of the control law that is selected."""
        names, law = law_names(), int(self._records()[1]["law"])
        return names[law] if law < len(names) else f"law {law}"  # of $LIMBER_LAWS there

    @property
    def stiffness(self) -> np.ndarray:
        """Cartesian stiffness K_x of this cycle, along its ramp and within its limits: N/m, N/rad
        and N m/rad, shape (6, 6).
        """
        return np.array(self._records()[1]["K_x"], float)

    @property
    def joint_stiffness(self) -> np.ndarray:
        """Joint stiffness K_q of this cycle, N m/rad or N/m."""
        return self._joint("K_q", of_status=True)

    @property
    def limits(self) -> list[str]:
        """Codes of the limits that act in this cycle, such as TORQUE; empty if none does."""
        return bit_names("controller_status_t", "LIMIT_", int(self._records()[1]["limits"]))

    @property
    def targets(self) -> Targets:
        """Targets with times that have come; see Targets."""
        return targets_of(self._records()[1])

    @property
    def faults(self) -> list[str]:
        """Faults in words: code, joint, meaning and remedy; empty if there is none."""
        state, status = self._records()
        # The reason stays in the status until it is acknowledged; what has passed is no fault.
        reason = status["reason"] if self.mode in ("init", "fault", "estop") else 0
        found = [
            ("controller", reason, status["reason_joint"]),
            ("driver", state["fault"], state["fault_joint"]),
            ("stop", state["emergency_stop"], -1),
            ("sensor", state["sensor_state"], -1),
        ]
        return [text for row in found if (text := self._in_words(*row))]

    @property
    def warnings(self) -> list[str]:
        """Warnings of the drives, code and joint; empty if there is none."""
        flags, names = self._records()[0]["joint_flags"], self._joint_names()
        return [
            f"{found.code} ({name})"
            for name, bits in zip((*names, HAND), flags, strict=False)
            for found in problems_of_bits("joint", int(bits))
        ]

    def _in_words(self, group: str, value: int, joint: int) -> str:
        found = problem(group, int(value))
        if found is None:
            return ""
        names = (*self._joint_names(), HAND)
        where = f" ({names[joint]})" if 0 <= joint < len(names) else ""
        return f"{found.code}{where}: {sentence(found.what)} To do: {found.remedy}."


class State(Quantities):
    """The quantities of one moment; they stay as they are."""

    def __init__(self, joint_state: np.void, status: np.void, joints: tuple[str, ...]) -> None:
        self.joint_state = joint_state
        self.status = status
        self._joints = joints

    def _records(self) -> tuple[np.void, np.void]:
        return self.joint_state, self.status

    def _joint_names(self) -> tuple[str, ...]:
        return self._joints

    def __repr__(self) -> str:
        p = ", ".join(f"{x:+.4f}" for x in self.pose.p)
        return f"<{self.mode}, law {self.law}, tip at [{p}] m, t = {self.time_s:.3f} s>"
