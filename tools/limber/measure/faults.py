"""The story of each fault: when, which joint, what was measured, what the arm did then."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from limber import messages
from limber.log.reader import Log, time_s
from limber.log.rows import active
from limber.model.robot import Robot
from limber.problems import MORE, Problem, groups, problem, sentence

JOINTS = np.arange(16)
AT_REST = 0.02  # rad/s or m/s


@dataclass(frozen=True)
class Fault:
    """From its first cause until the controller is ACTIVE again, or for ever (`until_s` infinite).

    `measured`: the number that tripped, with its limit where there is one; `also`: further codes.
    """

    problem: Problem
    time_s: float
    joint: str
    measured: str
    then: str
    also: tuple[str, ...]
    until_s: float

    @property
    def title(self) -> str:
        where = f", {self.joint}" if self.joint else ""
        measured = f": {self.measured}" if self.measured else ""
        return f"{self.problem.code} at {self.time_s:.3f} s{where}{measured}"

    def lines(self) -> list[str]:
        return [
            self.title,
            f"  {sentence(self.problem.what)}",
            f"  Then: {self.then}.",
            f"  To do: {self.problem.remedy}; {MORE}#{self.problem.anchor}",
        ]

    def as_json(self) -> dict[str, Any]:
        return {
            "code": self.problem.code,
            "at_s": self.time_s,
            "joint": self.joint,
            "what": self.problem.what,
            "measured": self.measured,
            "then": self.then,
            "also": list(self.also),
            "to_do": self.problem.remedy,
        }


@dataclass(frozen=True)
class _Onset:
    """A cause in JOINT_STATE (`of_driver`) or CONTROLLER_STATUS, from this row on."""

    of_driver: bool
    row: int
    time_s: float
    problem: Problem
    joint: int


def find_faults(log: Log, robot: Robot, end_s: float) -> list[Fault]:
    """All that began before `end_s`. What somebody requested is no fault."""
    evidence = Evidence(log, robot, end_s)
    onsets = _of_driver(evidence.state) + _of_controller(evidence.status)
    onsets.sort(key=lambda onset: (onset.time_s, not onset.of_driver))
    faults: list[Fault] = []
    while onsets:
        first = onsets.pop(0)
        until_s = evidence.active_again_s(first.time_s)
        also = []
        while onsets and onsets[0].time_s < until_s:
            also.append(onsets.pop(0).problem.code)
        faults.append(evidence.fault(first, also, until_s))
    return faults


def _of_driver(state: np.ndarray) -> list[_Onset]:
    changed = np.flatnonzero(np.diff(state["fault"], prepend=np.int8(0)))
    found = [(int(row), problem("driver", state["fault"][row])) for row in changed]
    t = time_s(state)
    return [
        _Onset(True, row, float(t[row]), cause, int(state["fault_joint"][row]))
        for row, cause in found
        if cause is not None and cause.code != "driver.REQUESTED"
    ]


def _of_controller(status: np.ndarray) -> list[_Onset]:
    in_fault = status["mode"] == messages.message_class("controller_status_t").MODE_FAULT
    begins = np.flatnonzero(in_fault & ~np.concatenate([[False], in_fault[:-1]]))
    found = [(int(row), problem("controller", status["reason"][row])) for row in begins]
    t = time_s(status)
    return [
        _Onset(False, row, float(t[row]), cause, int(status["reason_joint"][row]))
        for row, cause in found
        if cause is not None
    ]


class Evidence:
    """What the log has on a fault."""

    def __init__(self, log: Log, robot: Robot, end_s: float) -> None:
        self.robot = robot
        self.state = _before(log.read("JOINT_STATE"), end_s)
        self.status = _before(log.read("CONTROLLER_STATUS"), end_s)
        self.driver = log.read("DRIVER_STATUS")

    def active_again_s(self, time: float) -> float:
        times = time_s(self.status[active(self.status)])
        later = times[times > time]
        return float(later[0]) if len(later) else float("inf")

    def fault(self, onset: _Onset, also: list[str], until_s: float) -> Fault:
        measure = MEASURED.get(onset.problem.code)
        rows = self.state[time_s(self.state) <= onset.time_s]
        measured = measure(self, rows, onset) if measure and len(rows) else ""
        joint = self.robot.joint_names[onset.joint] if onset.joint >= 0 else ""
        then = self._then(onset.time_s, until_s)
        unique = tuple(dict.fromkeys(code for code in also if code != onset.problem.code))
        return Fault(onset.problem, onset.time_s, joint, measured, then, unique, until_s)

    def joint(self, index: int) -> dict[str, Any]:
        """As limber-check resolves it."""
        joints = self.robot.resolved["joints"]
        return joints[index] if index < len(joints) else {}

    def unit(self, index: int) -> str:
        return "m" if self.joint(index).get("type") == "prismatic" else "rad"

    def counted(self, time: float, field: str) -> np.ndarray:
        """By how much a counter of DRIVER_STATUS rose around a time."""
        after = self.driver[time_s(self.driver) >= time]
        before = self.driver[time_s(self.driver) < time]
        if not len(after):
            return np.zeros(1, int)
        earlier = before[-1][field] if len(before) else 0
        return np.atleast_1d(after[0][field] - earlier)

    def _then(self, start_s: float, until_s: float) -> str:
        """Drives, controller, and how the arm came to rest."""
        parts = [f"drives {word}" for word in _changes(self.state, "drive_state", start_s, until_s)]
        parts += [f"controller {word}" for word in _changes(self.status, "mode", start_s, until_s)]
        t = time_s(self.state)
        rows = self.state[(t >= start_s) & (t < until_s)]
        if not len(rows):
            return "; ".join(parts) or "the log ends"
        moving = np.flatnonzero((np.abs(rows["v"]) > AT_REST).any(axis=1))
        moved = _moved(rows)
        if not len(moving):
            rest = "the arm stood still"
        elif moving[-1] == len(rows) - 1:
            rest = "the arm still moved at the end"
        else:
            rest = f"the arm at rest {_after(float(time_s(rows)[moving[-1]]) - start_s)}"
        return "; ".join([*parts, f"{rest}; no joint moved by more than {moved:.2g} rad or m"])


NEVER = np.iinfo(np.int32).max  # age_cycles of a joint that has not been read yet


def _moved(rows: np.ndarray) -> float:
    """Of any joint, from its first reading on."""
    away = np.abs(rows["q"] - rows["q"][np.argmax(rows["age_cycles"] != NEVER, axis=0), JOINTS])
    return float(np.where(rows["age_cycles"] != NEVER, away, 0.0).max())


def _before(records: np.ndarray, end_s: float) -> np.ndarray:
    return records[time_s(records) < end_s]


def _after(seconds: float) -> str:
    return "at once" if seconds < 1e-3 else f"after {seconds:.2g} s"


WORDS = {
    "drive_state": ("joint_state_t", "DRIVE_"),
    "mode": ("controller_status_t", "MODE_"),
}


MOST_CHANGES = 6  # of drives that are configured again and again, for example


def _changes(records: np.ndarray, field: str, start_s: float, until_s: float) -> list[str]:
    """ "FALLBACK at once", "FAULT after 0.02 s"; what was the same before is left out."""
    names = messages.constants(*WORDS[field])
    t = time_s(records)
    found, last = [], None
    earlier = records[t < start_s]
    if len(earlier):
        last = int(earlier[-1][field])
    for row in np.flatnonzero((t >= start_s) & (t <= until_s)):
        value = int(records[field][row])
        if value != last:
            word = names.get(value, str(value))
            word = "FALLBACK" if field == "drive_state" and word == "HOLD" else word
            found.append(f"{word} {_after(t[row] - start_s)}")
        last = value
    more = len(found) - MOST_CHANGES
    return found if more <= 0 else [*found[:MOST_CHANGES], f"changed {more} times more"]


Rows = np.ndarray


def _position(evidence: Evidence, rows: Rows, onset: _Onset) -> str:
    q = float(rows["q"][-1][onset.joint])
    joint, unit = evidence.joint(onset.joint), evidence.unit(onset.joint)
    if not joint:
        return f"{q:.4g} {unit}"
    low, high = joint["position_min"], joint["position_max"]
    limit = high if abs(q - high) < abs(q - low) else low
    return f"{q:.4g} {unit}, limit {limit:.4g} {unit}"


def _velocity(evidence: Evidence, rows: Rows, onset: _Onset) -> str:
    unit = evidence.unit(onset.joint) + "/s"
    last = rows[-3:]
    v = max((float(last[field][:, onset.joint][-1]) for field in ("v", "theta_dot")), key=abs)
    limit = evidence.joint(onset.joint).get("velocity_limit")
    return f"{v:.4g} {unit}" + (f", limit {limit:.4g} {unit}" if limit is not None else "")


def _reply(_evidence: Evidence, rows: Rows, onset: _Onset) -> str:
    n = int(rows["num_joints"][-1])
    ages = rows["age_cycles"][-1][:n]
    age = int(ages[onset.joint] if onset.joint >= 0 else ages.min(initial=0))
    if age == NEVER:
        return "no reply since the start"
    return f"no reply for {age} cycles" if age else ""


def _drive_error(_evidence: Evidence, rows: Rows, onset: _Onset) -> str:
    return f"the drive's code is {int(rows['drive_status'][-1][onset.joint]) & 0xFFFF:#x}"


def _feedback(evidence: Evidence, rows: Rows, onset: _Onset) -> str:
    unit = evidence.unit(onset.joint)
    effort = "N m" if unit == "rad" else "N"
    names = ("theta", "theta_dot", "tau", "tau_applied")
    angle, speed, tau, sent = (float(rows[name][-1][onset.joint]) for name in names)
    return f"{angle:.4g} {unit}, {speed:.4g} {unit}/s, {tau:.4g} of {sent:.4g} {effort}"


def _temperature(evidence: Evidence, rows: Rows, onset: _Onset) -> str:
    limit = evidence.joint(onset.joint).get("limit_temperature_degC")
    measured = f"{float(rows['temperature_degC'][-1][onset.joint]):.0f} degC"
    return measured + (f", limit {limit:.4g} degC" if limit is not None else "")


def _refused(evidence: Evidence, _rows: Rows, onset: _Onset) -> str:
    counts = evidence.counted(onset.time_s, "commands_refused")
    found = [(problem("gate", verdict), int(n)) for verdict, n in enumerate(counts) if n]
    return ", ".join(f"{cause.code} {n}" for cause, n in found if cause is not None)


def _missing(evidence: Evidence, _rows: Rows, onset: _Onset) -> str:
    return f"{int(evidence.counted(onset.time_s, 'commands_missing')[0])} cycles without an answer"


def _overruns(evidence: Evidence, _rows: Rows, onset: _Onset) -> str:
    return f"{int(evidence.counted(onset.time_s, 'overrun_cycles')[0])} cycles too long"


def _bus(evidence: Evidence, _rows: Rows, onset: _Onset) -> str:
    later = evidence.driver[time_s(evidence.driver) >= onset.time_s]
    if not len(later):
        return ""
    causes = [problem("bus", state) for state in later[0]["bus_state"]]
    return ", ".join(f"bus {b + 1}: {cause.code}" for b, cause in enumerate(causes) if cause)


def _stop(_evidence: Evidence, rows: Rows, _onset: _Onset) -> str:
    cause = problem("stop", rows["emergency_stop"][-1])
    return "" if cause is None else cause.code


def _strayed(evidence: Evidence, rows: Rows, onset: _Onset) -> str:
    on = rows["drive_state"] == messages.message_class("joint_state_t").DRIVE_ON
    begins = np.flatnonzero(on & ~np.concatenate([[False], on[:-1]]))
    if not len(begins) or onset.joint < 0:
        return ""
    moved = float(rows["theta"][-1][onset.joint] - rows["theta"][begins[-1]][onset.joint])
    return f"moved by {moved:.3g} {evidence.unit(onset.joint)} since the drives came on"


def _stands(evidence: Evidence, rows: Rows, onset: _Onset) -> str:
    theta = rows["theta"][:, onset.joint]
    other = np.flatnonzero(theta != theta[-1])
    since = rows[other[-1] if len(other) else 0]
    stood_s = float(rows["time_ns"][-1] - since["time_ns"]) * 1e-9
    return f"{float(theta[-1]):.4g} {evidence.unit(onset.joint)} for {stood_s:.3g} s"


def _factor(evidence: Evidence, rows: Rows, onset: _Onset) -> str:
    """Of the torque that carried the joint when it was slow last."""
    joints = len(evidence.robot.joints)
    slow = np.abs(rows["v"][:, onset.joint]) < AT_REST
    on = rows["drive_state"] == messages.message_class("joint_state_t").DRIVE_ON
    if not np.any(slow & on):
        return ""
    rest = rows[slow & on][-1]
    weight_Nm = evidence.robot.dynamics.gravity_torque(rest["q"][None, :joints])[0][onset.joint]
    reported_Nm = float(rest["tau_applied"][onset.joint])
    return f"its weight of {weight_Nm:.3g} N m is {weight_Nm / reported_Nm:.2g} times the torque"


def _energy(evidence: Evidence, _rows: Rows, onset: _Onset) -> str:
    last = evidence.status[max(onset.row - 1, 0) : onset.row + 1]
    both = np.minimum(last["kinetic_energy_J"], last["unexplained_energy_J"])
    limit = evidence.robot.resolved["energy_limit_J"]
    return f"{both.max():.3g} J" + (f", limit {limit:.3g} J" if limit is not None else "")


MEASURED: dict[str, Callable[[Evidence, Rows, _Onset], str]] = {
    "driver.POSITION": _position,
    "driver.VELOCITY": _velocity,
    "driver.REPLY_LOST": _reply,
    "driver.DRIVE_ERROR": _drive_error,
    "driver.FEEDBACK": _feedback,
    "driver.TEMPERATURE": _temperature,
    "driver.COMMAND_REFUSED": _refused,
    "driver.CONTROLLER_LOST": _missing,
    "driver.OVERRUN": _overruns,
    "driver.BUS": _bus,
    "driver.EMERGENCY_STOP": _stop,
    "controller.STRAYED": _strayed,
    "controller.OVERDRIVEN": _factor,
    "controller.ENCODER_STOPPED": _stands,
    "controller.ENERGY": _energy,
}
assert all(code.split(".")[1] in groups()[code.split(".")[0]].problems for code in MEASURED)
