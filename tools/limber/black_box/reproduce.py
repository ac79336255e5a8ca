"""A scenario from a log: the same arm, pose, law, goals, pushes and drive fault, in simulation.

What a log does not hold cannot be in it: walls, payloads, damping and choices of the gains, and
goals of laws for the joints. A contact is played as the push it was.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import yaml

from limber.log.reader import Log, time_s
from limber.log.rows import active, stretches
from limber.messages import message_class
from limber.model.gains_table import law_names
from limber.problems import Problem, problem

STATE, STATUS = message_class("joint_state_t"), message_class("controller_status_t")
SETTLED_S = 1.5  # of the scenario: the arm is held, active, and has its gains
AFTER_S = 1.0
STILL = 1e-6  # m or rad from status to status
SAME_N = 0.05  # N or N m
PAUSE_S = 0.05
# Which fault of a simulated drive does what was found, by the code of what was found.
FAULTS = {
    "driver.REPLY_LOST": "silent",
    "driver.DRIVE_ERROR": "drive_error",
    "driver.TEMPERATURE": "hot",
    "controller.ENCODER_STOPPED": "frozen_encoder",
}


@dataclass
class Reproduction:
    """`cause`: the first problem of the log; `notes`: what the scenario leaves out."""

    scenario: dict[str, Any]
    cause: Problem | None
    notes: list[str] = field(default_factory=list)

    def text(self) -> str:
        lines = ["# Made from a log by `limber log black-box`."]
        if self.cause:
            lines.append(f"# It led to {self.cause.code}: {self.cause.what}.")
        lines += [f"# {note}." for note in self.notes]
        head = yaml.safe_dump(self.scenario, sort_keys=False, default_flow_style=None, width=140)
        return "\n".join(lines) + "\n" + head


def reproduction(log: Log, robot: str, joints: list[str]) -> Reproduction | None:
    """None for a log without a state in which all drives had answered. `robot`: as in a scenario.

    The scenario ends soon after the first fault: what came after it followed from it.
    """
    state, status, truth = (log.read(c) for c in ("JOINT_STATE", "CONTROLLER_STATUS", "SIM_TRUTH"))
    n = len(joints)
    fresh = (state["joint_flags"][:, :n] & STATE.JOINT_FRESH) != 0
    known = np.logical_or.accumulate(fresh).all(axis=1)
    if not known.any():
        return None
    state = state[np.argmax(known) :]
    session = state["session"] == state["session"][0]  # another run of the driver: time begins anew
    state = state[session]
    begin_s = float(time_s(state)[0])
    found = _first_fault(state, status)
    end_s = found.time_s if found else float(time_s(state)[-1])
    status, truth = _within(status, begin_s, end_s), _within(truth, begin_s, np.inf)
    q = state["q"][0, :n] if not len(truth) else truth["q"][0, :n]

    def at(when_s: float) -> float:
        return round(float(when_s - begin_s) + SETTLED_S, 3)

    timeline: list[dict[str, Any]] = [
        {"at_s": 0.3, "mode": "hold"},
        {"at_s": 0.8, "mode": "active"},
    ]
    notes: list[str] = []
    under_law = status[active(status)]
    if len(under_law):
        timeline += _gains(under_law, n, at)
        timeline += _goals(under_law, at, notes)
    else:
        timeline.pop()
        notes.append("No law ran in the time that was kept")
    timeline += _pushes(truth, end_s, at)
    if _within(truth, begin_s, end_s)["contact"].any():
        notes.append("The arm touched something; the force of the contact is played as a push")
    fault = _fault(found, joints) if found else None
    if fault and found:
        began_s = _began_s(found, state, fault)
        timeline.append({"at_s": at(began_s), "fault": fault})
    scenario = {
        "format": "limber-scenario/1",
        "name": "reproduce",
        "robot": robot,
        "mode": "lockstep",
        "duration_s": round(at(end_s) + AFTER_S, 3),
        "seed": 1,
        "start_q": np.round(q.astype(float), 6).tolist(),
        "timeline": sorted(timeline, key=lambda entry: entry["at_s"]),
    }
    return Reproduction(scenario, found.problem if found else None, notes)


@dataclass(frozen=True)
class _Found:
    time_s: float
    problem: Problem
    joint: int


def _first_fault(state: np.ndarray, status: np.ndarray) -> _Found | None:
    """Of the driver or of the controller, the earlier one; what somebody wanted is none."""
    found = []
    for group, records, value, joint, fine in (
        ("driver", state, "fault", "fault_joint", (STATE.FAULT_NONE, STATE.FAULT_REQUESTED)),
        (
            "controller",
            status,
            "reason",
            "reason_joint",
            (STATUS.REASON_NONE, STATUS.REASON_STOP_REQUESTED, STATUS.REASON_DRIVER_FAULT),
        ),
    ):
        rows = np.flatnonzero(~np.isin(records[value], fine))
        if len(rows):
            first = records[rows[0]]
            cause = problem(group, first[value])
            if cause is not None:
                found.append(_Found(float(first["time_ns"] * 1e-9), cause, int(first[joint])))
    return min(found, key=lambda one: one.time_s, default=None)


def _within(records: np.ndarray, begin_s: float, end_s: float) -> np.ndarray:
    t = time_s(records)
    return records[(t >= begin_s) & (t <= end_s)]


def _gains(status: np.ndarray, n: int, at: Any) -> Iterator[dict[str, Any]]:
    """The stiffness and the law at the start, and what each later change led to."""
    t = time_s(status)
    stiffness = np.column_stack([status["K_x"].reshape(len(status), 36), status["K_q"][:, :n]])
    changed = np.zeros(len(status), bool)
    changed[1:] = np.any(np.diff(stiffness, axis=0) != 0, axis=1) | (np.diff(status["law"]) != 0)
    yield {"at_s": 1.0, "gains": {**_gains_of(status[0], n), "ramp_s": 0.1}}
    for rows in stretches(t, changed, PAUSE_S):
        begin, end = float(t[rows.start - 1]), float(t[rows.stop - 1])
        gains = {**_gains_of(status[rows.stop - 1], n), "ramp_s": round(end - begin, 3)}
        yield {"at_s": at(begin), "gains": gains}


def _gains_of(row: np.void, n: int) -> dict[str, Any]:
    laws = law_names()
    named = {"law": laws[row["law"]]} if 0 <= row["law"] < len(laws) else {}
    K_x = np.round((row["K_x"] + row["K_x"].T) / 2, 3)  # float32 is not exactly symmetric
    K_q = np.round(row["K_q"][:n].astype(float), 3).tolist()
    return {**named, **_tip_stiffness(K_x.astype(float)), "K_q_Nm_per_rad": K_q}


def _tip_stiffness(K_x: np.ndarray) -> dict[str, Any]:
    if np.any(K_x - np.diag(np.diag(K_x))):
        return {"K_x": K_x.tolist()}
    translation, rotation = np.split(np.diag(K_x), 2)
    return {
        "K_x_translation_N_per_m": translation.tolist(),
        "K_x_rotation_Nm_per_rad": rotation.tolist(),
    }


def _goals(status: np.ndarray, at: Any, notes: list[str]) -> Iterator[dict[str, Any]]:
    """The goal at the tip at the start, and each of its motions from rest to rest."""
    t = time_s(status)
    pose = np.column_stack([status["p_BD"], status["quat_BD"]])
    away = np.abs(status["e"][0]).max() if len(status) else 0.0
    if away > 1e-3:
        yield {"at_s": 1.1, "goal": _goal_of(pose[0], 0.2)}
    moves = np.zeros(len(status), bool)
    moves[1:] = np.abs(np.diff(pose, axis=0)).max(axis=1) > STILL
    for rows in stretches(t, moves, PAUSE_S):
        begin, end = float(t[rows.start - 1]), float(t[rows.stop - 1])
        if rows.start == 1:
            notes.append("A motion of the goal had begun before")
        yield {"at_s": at(begin), "goal": _goal_of(pose[rows.stop - 1], end - begin)}


def _goal_of(pose: np.ndarray, duration_s: float) -> dict[str, Any]:
    quaternion = pose[3:] / np.linalg.norm(pose[3:])
    return {
        "position_m": np.round(pose[:3], 6).tolist(),
        "quaternion_wxyz": np.round(quaternion, 9).tolist(),
        "duration_s": round(duration_s, 3),
    }


def _pushes(truth: np.ndarray, end_s: float, at: Any) -> Iterator[dict[str, Any]]:
    """Pushes, and contacts until the fault, each with the mean of its plateau."""
    t = time_s(truth)
    wrench = truth["F_push"] + truth["F_contact"] * (t <= end_s)[:, None]
    size = np.abs(wrench).max(axis=1, initial=0.0)
    for number, rows in enumerate(stretches(t, size > SAME_N, PAUSE_S), 1):
        plateau = size[rows] > 0.9 * np.quantile(size[rows], 0.7)  # not the peak of a blow
        begin, end = float(t[rows.start]), float(t[rows.stop - 1])
        rise = float(t[rows][np.argmax(plateau)]) - begin
        length = max(end - begin, 0.01)
        mean = np.round(wrench[rows][plateau].mean(axis=0), 3).tolist()
        push = {
            "id": number,
            "force_N": mean[:3],
            "torque_Nm": mean[3:],
            # nine tenths of a cosine edge are reached after 0.795 of its length
            "ramp_s": round(min(rise / 0.795, length / 2), 3),
            "for_s": round(length, 3),
        }
        yield {"at_s": at(begin), "push": push}


def _began_s(found: _Found, state: np.ndarray, fault: dict[str, Any]) -> float:
    """Faults are found some time after they began: when the joint's position changed last, or its
    drive replied last.
    """
    before = state[time_s(state) < found.time_s]
    if "joint" not in fault or len(before) < 2:
        return found.time_s
    if fault["kind"] == "frozen_encoder":
        alive = np.diff(before["q"][:, found.joint], prepend=np.nan) != 0
    else:
        alive = (before["joint_flags"][:, found.joint] & STATE.JOINT_FRESH) != 0
    return float(time_s(before)[np.flatnonzero(alive)[-1]]) if alive.any() else found.time_s


def _fault(found: _Found, joints: list[str]) -> dict[str, Any] | None:
    if found.problem.code == "driver.EMERGENCY_STOP":
        return {"input": "emergency_stop", "kind": "pressed"}
    kind = FAULTS.get(found.problem.code)
    if kind is None or not 0 <= found.joint < len(joints):
        return None
    return {"joint": joints[found.joint], "kind": kind}
