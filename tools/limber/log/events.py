"""What happened when in a log: modes, requests, refusals, faults, limits, pushes, contacts."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from limber.arrays import Floats
from limber.log.episodes import episodes
from limber.log.event_index import NO_EVENTS
from limber.log.reader import Log, time_s
from limber.log.rows import stretches
from limber.messages import CLIENTS, constants, driven_joints, joint_name, message_class
from limber.problems import Problem, groups, problem

# What of the messages tells of events: a long log fits into memory
STATE_FIELDS: tuple[str, ...] = ("num_joints", "joint_flags", "sensor_state", "emergency_stop")
STATE_FIELDS += ("drive_state", "fault", "fault_joint")
STREAM_FIELDS = ("stream", "stream_late", "stream_stale", "stream_refused")
STATUS_FIELDS = ("mode", "reason", "reason_joint", "law", "limits", *STREAM_FIELDS)
TRUTH_FIELDS = ("F_push", "contact", "F_contact")
PAUSE_S = 0.1  # what acts again within this time has acted all the time


@dataclass(frozen=True)
class Event:
    time_s: float
    who: str
    text: str
    bad: bool = False


@dataclass(frozen=True)
class Names:
    """Of the numbers in messages; what is missing stays a number."""

    joints: list[str]
    laws: list[str]

    def joint(self, index: int) -> str:
        return joint_name(self.joints, index)

    def law(self, index: int) -> str:
        return self.laws[index] if 0 <= index < len(self.laws) else f"law number {index}"


def events(log: Log, names: Names) -> list[Event]:
    """In order of time; of the same time, the cause before the consequence."""
    state = log.fields("JOINT_STATE", "time_ns", *STATE_FIELDS)
    status = log.fields("CONTROLLER_STATUS", "time_ns", *STATUS_FIELDS)
    truth = log.fields("SIM_TRUTH", "time_ns", *TRUTH_FIELDS)
    driver = log.read("DRIVER_STATUS")
    found = [
        *_requests(log),
        *_drives(state, names),
        *_flags(state, names),
        *_buses(driver),
        *_refused_commands(driver),
        *_modes(status, names, _requested_s(state)),
        *_laws(status, names),
        *_limits(status),
        *_pushes(truth),
        *_contacts(truth),
        *_streams(status),
        *_grasps(log.fields("HAND_STATE", "time_ns", "grasped", "width_m")),
        *_episodes(log),
    ]
    return sorted(found, key=lambda event: event.time_s)


def _grasps(hand: np.ndarray) -> Iterator[Event]:
    for rows, length_s in _stretches(time_s(hand), hand["grasped"] != 0):
        width_mm = float(hand["width_m"][rows.stop - 1]) * 1e3
        text = f"hand: grasped for {length_s:.3g} s, {width_mm:.1f} mm wide"
        yield Event(float(time_s(hand)[rows.start]), "controller", text)


def _episodes(log: Log) -> Iterator[Event]:
    for one in episodes(log):
        words = f"{one.outcome or 'no end'}{', dropped' * one.dropped} after {one.length_s:.3g} s"
        task = f" ({one.task})" if one.task else ""
        at_s = _arm_time_s(log, one.start_us)
        yield Event(at_s, "recorder", f"episode {one.number}{task}: {words}")


def _arm_time_s(log: Log, stamp_us: int) -> float:
    """Of the newest JOINT_STATE then, else of the first."""
    stamps_us = log.channels.get("JOINT_STATE", NO_EVENTS).stamps_us
    row = max(int(np.searchsorted(stamps_us, stamp_us, side="right")) - 1, 0)
    found = log.records("JOINT_STATE", row, row + 1)[1]
    return float(time_s(found)[0]) if len(found) else 0.0


def _changes(records: np.ndarray, *fields: str) -> Iterator[int]:
    """Rows where a field is another than in the row before, and the first."""
    if not len(records):
        return
    changed = np.zeros(len(records), bool)
    changed[0] = True
    for name in fields:
        changed[1:] |= records[name][1:] != records[name][:-1]
    yield from (int(row) for row in np.flatnonzero(changed))


def _stretches(t: np.ndarray, acts: np.ndarray) -> Iterator[tuple[slice, float]]:
    """Where something acts, and for how long."""
    for rows in stretches(t, acts, PAUSE_S):
        yield rows, float(t[rows.stop - 1] - t[rows.start])


WHAT = {
    "MODE": ("mode_request_t", "REQUEST_"),
    "GOAL": ("compliance_goal_t", "GOAL_"),
    "STREAM": ("target_stream_t", "KIND_"),
}


def _requests(log: Log) -> Iterator[Event]:
    kinds = constants("request_answer_t", "KIND_")
    for answer in log.decode("REQUEST_ANSWER"):
        kind = kinds.get(answer.kind, "REQUEST")
        words = constants(*WHAT[kind]) if kind in WHAT else {}
        what = f"{kind} {words.get(answer.what, '')}".strip().lower()
        who = CLIENTS.get(answer.client, f"client {answer.client}")
        if answer.accepted:
            yield Event(answer.time_ns * 1e-9, who, f"{what}: taken")
            continue
        cause = problem("request", answer.code)
        code = f"{cause.code}: " if cause else ""
        yield Event(answer.time_ns * 1e-9, who, f"{what}: refused: {code}{answer.reason}", bad=True)


def _drives(state: np.ndarray, names: Names) -> Iterator[Event]:
    words = constants("joint_state_t", "DRIVE_")
    t, fault = time_s(state), 0
    for row in _changes(state, "drive_state", "fault"):
        word = words.get(int(state["drive_state"][row]), "unknown").replace("HOLD", "FALLBACK")
        now = int(state["fault"][row])
        cause = problem("driver", now) if now != fault else None
        joint = int(state["fault_joint"][row])
        bad = cause is not None and cause.code != "driver.REQUESTED"
        yield Event(float(t[row]), "driver", f"drives {word}{_because(cause, joint, names)}", bad)
        fault = now
    for group, field in (("sensor", "sensor_state"), ("stop", "emergency_stop")):
        fine = groups()[group].fine
        for row in list(_changes(state, field))[0 if _wrong(state, group, field) else 1 :]:
            cause = problem(group, state[field][row])
            text = f"{cause.code}: {cause.what}" if cause else f"{group}: {fine[-1].lower()}"
            yield Event(float(t[row]), "driver", text, cause is not None)


def _wrong(state: np.ndarray, group: str, field: str) -> bool:
    return bool(len(state)) and problem(group, state[field][0]) is not None


def _because(cause: Problem | None, joint: int, names: Names) -> str:
    if cause is None:
        return ""
    where = f" ({names.joint(joint)})" if joint >= 0 else ""
    return f": {cause.code}{where}: {cause.what}"


def _flags(state: np.ndarray, names: Names) -> Iterator[Event]:
    """Of each joint, what may be wrong with it."""
    if not len(state):
        return
    t, group = time_s(state), groups()["joint"]
    bits = {name: bit for bit, name in constants(group.message, group.prefix).items()}
    for name, cause in group.problems.items():
        for joint in range(driven_joints(state[0])):
            for rows, length_s in _stretches(t, state["joint_flags"][:, joint] & bits[name] != 0):
                text = f"{cause.code} ({names.joint(joint)}) for {length_s:.3g} s: {cause.what}"
                yield Event(float(t[rows.start]), "driver", text, bad=True)


def _buses(driver: np.ndarray) -> Iterator[Event]:
    t = time_s(driver)
    for bus in range(int(driver["num_buses"][0]) if len(driver) else 0):
        last = None
        for row, value in enumerate(driver["bus_state"][:, bus]):
            cause = problem("bus", value)
            if cause != last:
                text = f"{cause.code}: {cause.what}" if cause else "good again"
                yield Event(float(t[row]), "driver", f"bus {bus + 1}: {text}", cause is not None)
            last = cause


def _refused_commands(driver: np.ndarray) -> Iterator[Event]:
    t = time_s(driver)
    counts = driver["commands_refused"].astype(int)
    for row in range(len(driver)):
        new = counts[row] - (counts[row - 1] if row else 0)
        for verdict in np.flatnonzero(new > 0):
            cause = problem("gate", int(verdict))
            if cause is not None:
                text = f"{cause.code}: {int(new[verdict])} commands refused: {cause.what}"
                yield Event(float(t[row]), "driver", text, bad=True)


def _requested_s(state: np.ndarray) -> Floats:
    """When the drives hold or brake because somebody wanted it."""
    requested = state["fault"] == message_class("joint_state_t").FAULT_REQUESTED
    times_s: Floats = time_s(state)[requested]
    return times_s


def _modes(status: np.ndarray, names: Names, requested_s: np.ndarray) -> Iterator[Event]:
    """A mode that follows what somebody wanted of the drives is no fault of the arm."""
    words = constants("controller_status_t", "MODE_")
    t, reason = time_s(status), 0
    for row in _changes(status, "mode", "reason"):
        now = int(status["reason"][row])
        cause = problem("controller", now) if now != reason else None
        text = f"mode {words.get(int(status['mode'][row]), 'unknown')}"
        text += _because(cause, int(status["reason_joint"][row]), names)
        wanted = np.any(np.abs(requested_s - t[row]) < PAUSE_S)
        fine = ("controller.STOP_REQUESTED", "controller.DRIVER_FAULT" if wanted else "")
        bad = cause is not None and cause.code not in fine
        yield Event(float(t[row]), "controller", text, bad)
        reason = now


def _laws(status: np.ndarray, names: Names) -> Iterator[Event]:
    t = time_s(status)
    for row in _changes(status, "law"):
        yield Event(float(t[row]), "controller", f"law {names.law(int(status['law'][row]))}")


def _limits(status: np.ndarray) -> Iterator[Event]:
    t, group = time_s(status), groups()["limit"]
    for bit, name in constants(group.message, group.prefix).items():
        cause = group.problems[name]
        for rows, length_s in _stretches(t, status["limits"] & bit != 0):
            text = f"{cause.code} for {length_s:.3g} s: {cause.what}"
            yield Event(float(t[rows.start]), "controller", text)


def _streams(status: np.ndarray) -> Iterator[Event]:
    """Targets that come, run out, and are not used as they were meant."""
    words = {
        "NONE": "stream ends",
        "RUNNING": "stream of targets",
        "WAITING": "stream: the targets ran out, the goal comes to rest",
    }
    known = constants("controller_status_t", "STREAM_")
    t = time_s(status)
    for row in list(_changes(status, "stream"))[1:]:
        text = words[known.get(int(status["stream"][row]), "NONE")]
        yield Event(float(t[row]), "controller", text)
    for what in ("late", "stale", "refused"):
        count = status[f"stream_{what}"].astype(int)
        rises = np.diff(count, prepend=count[:1]) > 0
        for rows, length_s in _stretches(t, rises):
            many = count[rows.stop - 1] - count[max(rows.start - 1, 0)]
            text = f"stream: {many} messages {what} in {length_s:.3g} s"
            yield Event(float(t[rows.start]), "controller", text, bad=what == "refused")


def _pushes(truth: np.ndarray) -> Iterator[Event]:
    t, pushed = time_s(truth), np.abs(truth["F_push"]).max(axis=1, initial=0.0) > 0.0
    for rows, length_s in _stretches(t, pushed):
        yield Event(
            float(t[rows.start]),
            "world",
            f"push for {length_s:.3g} s, {_most(truth['F_push'][rows])}",
        )


def _contacts(truth: np.ndarray) -> Iterator[Event]:
    t = time_s(truth)
    for rows, length_s in _stretches(t, truth["contact"] != 0):
        yield Event(
            float(t[rows.start]),
            "world",
            f"contact for {length_s:.3g} s, {_most(truth['F_contact'][rows])}",
        )


def _most(wrench: np.ndarray) -> str:
    force, moment = (np.linalg.norm(part, axis=1).max() for part in (wrench[:, :3], wrench[:, 3:]))
    parts = [f"{force:.3g} N"] * bool(force) + [f"{moment:.3g} N m"] * bool(moment)
    return f"up to {' and '.join(parts)}"
