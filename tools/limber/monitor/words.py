"""What is going on, in words: mode, faults and limits that act, each with what to do."""

from dataclasses import dataclass, field, replace

import numpy as np

from limber import problems
from limber.messages import constants, driven_joints, joint_name, message_class
from limber.monitor.feed import NEVER_S, Feed
from limber.problems import Problem, sentence

STALE_S = 0.8  # a busy machine stands still for tenths of a second
GOOD, WARN, BAD = "good", "warn", "bad"
WANTED = ("driver.REQUESTED", "controller.STOP_REQUESTED")  # by the user: no fault
CAUSES_FIRST = ("stop", "driver", "controller", "bus", "joint", "sensor", "limit")
FOLLOWS = ("controller.DRIVER_FAULT",)  # of a fault that the driver reports itself
FAULTY = ("FAULT", "ESTOP")
STATE = message_class("joint_state_t")
IN_FALLBACK = "the drives hold the arm by themselves; hold takes it over"
LET_GO = "a drive is off or in error, the others hold the arm: support it; {}, hold, active"
IDLE_FIRST = "idle (releases all drives)"
LET_GO_WORDS = {
    "IDLE": LET_GO.format(IDLE_FIRST),
    "FAULT": LET_GO.format(f"acknowledge, {IDLE_FIRST}"),
}
MODE_WORDS = {
    "BOOT": "waiting for the driver",
    "INIT": "checking the arm's state",
    "IDLE": "ready; the drives are off",
    "HOLD": "holds its position",
    "ACTIVE": "a control law is running",
    "SOFT_STOP": "coming to rest",
    "FAULT": "stopped by a fault; when its cause is gone: acknowledge, hold, active",
    "ESTOP": "the emergency stop is pressed; release it, then acknowledge",
}


@dataclass(frozen=True)
class Note:
    """`code` may be looked up in docs/troubleshooting.md; `do` may be empty."""

    level: str
    code: str
    what: str
    do: str = ""


@dataclass
class Situation:
    """`mode`: the controller's, empty if it is silent; `notes`: the cause first; `fallback`: the
    drives hold the arm by themselves; `let_go`: but for one that is off or in error.
    """

    level: str
    headline: str
    detail: str
    notes: list[Note] = field(default_factory=list)
    mode: str = ""
    fallback: bool = False
    let_go: bool = False

    @property
    def faulty(self) -> bool:
        return self.mode in FAULTY


def situation(feed: Feed, joints: list[str], limits: int = 0) -> Situation:
    """Of the newest messages and their age; a stack that is silent is dead. `limits`: bits that
    acted lately.
    """
    ages = {
        name: feed.age_s(name) if name in feed.newest else NEVER_S  # heard, and not taken yet
        for name in ("JOINT_STATE", "CONTROLLER_STATUS")
    }
    if all(age == NEVER_S for age in ages.values()):
        return Situation(BAD, "NO STACK", "No messages on this machine. Start one: limber demo")
    if ages["JOINT_STATE"] > STALE_S:
        return _silent("NO DRIVER", "JOINT_STATE", ages, _notes(feed, joints))
    if ages["CONTROLLER_STATUS"] > STALE_S:
        return _silent("NO CONTROLLER", "CONTROLLER_STATUS", ages, _notes(feed, joints))
    status = feed.newest["CONTROLLER_STATUS"]
    mode = constants("controller_status_t", "MODE_").get(int(status["mode"]), "UNKNOWN")
    notes = _notes(feed, joints)
    for problem in problems.problems_of_bits("limit", limits | int(status["limits"])):
        notes += _note(WARN, problem)
    level = GOOD if mode in ("HOLD", "ACTIVE") else WARN
    if mode in ("FAULT", "ESTOP") or any(note.level == BAD for note in notes):
        level = BAD
    ranked = sorted(notes, key=_rank)
    state = feed.newest["JOINT_STATE"]
    fallback = int(state["drive_state"]) == STATE.DRIVE_HOLD
    flags = state["joint_flags"][: int(state["num_joints"])]
    let_go = fallback and not np.all(flags & STATE.JOINT_ENABLED)
    words = IN_FALLBACK if fallback and mode == "IDLE" else MODE_WORDS.get(mode, "")
    words = LET_GO_WORDS.get(mode, words) if let_go else words
    return Situation(level, mode.replace("_", " "), words, ranked, mode, fallback, let_go)


def mode_of(feed: Feed) -> str:
    """The controller's newest; empty if it is silent."""
    status = feed.newest.get("CONTROLLER_STATUS")
    if status is None or feed.age_s("CONTROLLER_STATUS") > STALE_S:
        return ""
    return constants("controller_status_t", "MODE_").get(int(status["mode"]), "UNKNOWN")


def _rank(note: Note) -> tuple[bool, bool, int]:
    """What is wrong before what limits, and the cause before what follows from it."""
    code = note.code.split(" ")[0]
    group = code.split(".")[0]
    place = CAUSES_FIRST.index(group) if group in CAUSES_FIRST else len(CAUSES_FIRST)
    return note.level != BAD, code in (*WANTED, *FOLLOWS), place


def _silent(headline: str, channel: str, ages: dict[str, float], notes: list[Note]) -> Situation:
    age = ages[channel]
    ago = "no message yet" if age == NEVER_S else f"last message {np.floor(2 * age) / 2} s ago"
    detail = f"{channel}: {ago}. What is shown is old."
    return Situation(BAD, headline, detail, notes)


def _notes(feed: Feed, joints: list[str]) -> list[Note]:
    state, status = feed.newest.get("JOINT_STATE"), feed.newest.get("CONTROLLER_STATUS")
    found: list[Note] = []
    if state is not None:
        where = _joint(joints, int(state["fault_joint"]))
        found += _note(BAD, problems.problem("driver", state["fault"]), where)
        found += _note(BAD, problems.problem("stop", state["emergency_stop"]))
        found += _note(WARN, problems.problem("sensor", state["sensor_state"]))
        found += _joint_notes(state, joints)
    if status is not None:
        where = _joint(joints, int(status["reason_joint"]))
        found += _note(BAD, problems.problem("controller", status["reason"]), where)
    found += _bus_notes(feed.newest.get("DRIVER_STATUS"))
    return found


def _joint_notes(state: np.void, joints: list[str]) -> list[Note]:
    """One of each kind, with the joints that have it."""
    found: dict[str, tuple[Note, list[str]]] = {}
    for i in range(driven_joints(state)):
        for problem in problems.problems_of_bits("joint", state["joint_flags"][i]):
            (note,) = _note(WARN, problem)
            found.setdefault(note.code, (note, []))[1].append(_joint(joints, i))
    return [
        replace(note, code=f"{note.code} ({', '.join(where)})") for note, where in found.values()
    ]


def _bus_notes(driver: np.void | None) -> list[Note]:
    found: list[Note] = []
    if driver is not None:
        for bus, value in enumerate(driver["bus_state"][: int(driver["num_buses"])]):
            found += _note(BAD, problems.problem("bus", value), f"bus {bus + 1}")
    return found


def _note(level: str, problem: Problem | None, where: str = "") -> list[Note]:
    if problem is None:
        return []
    if problem.code in WANTED:
        level = WARN
    code = problem.code + (f" ({where})" if where else "")
    do = sentence(problem.remedy) if problem.remedy else ""
    return [Note(level, code, sentence(problem.what), do)]


def _joint(names: list[str], index: int) -> str:
    if index < 0:
        return ""
    return joint_name(names, index)
