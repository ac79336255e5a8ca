"""The arm's condition as ROS's diagnostics: one status of the arm, one a joint, one of commands."""

from limber.live.arm_state import State
from limber.messages import HAND, constants, message_class
from limber.problems import problems_of_bits, sentence
from limber.ros2 import ros_types as ros
from limber.ros2.from_ros import Outcomes

FAULTY = ("fault", "estop")
USUAL = ("RAMP",)  # a limit that a request has asked for


def arm_status(state: State, robot: str) -> ros.DiagnosticStatus:
    """Mode, law, faults with their words and remedies."""
    faults, limits = state.faults, [name for name in state.limits if name not in USUAL]
    level = ros.ERROR if faults or state.mode in FAULTY else ros.WARN if limits else ros.OK
    acting = [f"limits act: {', '.join(limits)}"] if limits else []
    sources = constants("compliance_gains_t", "CONTACT_")
    values = {
        "mode": state.mode,
        "drives": state.drives,
        "law": state.law,
        "limits": ", ".join(state.limits),
        "contact_wrench": sources[int(state.status["contact"])].lower(),
        **{f"fault {number}": text for number, text in enumerate(faults, 1)},
    }
    return _status(level, "arm", robot, " ".join([state.mode, *faults, *acting]), values)


def joint_statuses(state: State, joints: tuple[str, ...], robot: str) -> list[ros.DiagnosticStatus]:
    """Of every joint, and of the hand if there is one: what is wrong with its drive."""
    record, kind = state.joint_state, message_class("joint_state_t")
    found = []
    for i, name in enumerate((*joints, HAND)[: len(record["joint_flags"])]):
        flags = int(record["joint_flags"][i])
        if i == len(joints) and not flags & kind.JOINT_HAND:
            break
        wrong = problems_of_bits("joint", flags)
        bad = flags & kind.JOINT_DRIVE_ERROR
        level = ros.ERROR if bad else ros.WARN if wrong else ros.OK
        values = {
            "problems": ", ".join(problem.code for problem in wrong),
            "enabled": str(bool(flags & kind.JOINT_ENABLED)).lower(),
            "drive_status": str(int(record["drive_status"][i])),
            "age_cycles": str(int(record["age_cycles"][i])),
        }
        for field in ("temperature_degC", "current_A"):
            if record[field][i]:  # zero where the drive reports none
                values[field] = f"{float(record[field][i]):.4g}"
        words = " ".join(f"{sentence(each.what)} To do: {each.remedy}." for each in wrong)
        found.append(_status(level, f"joint {name}", robot, words or "ok", values))
    return found


def command_status(outcomes: Outcomes | None, robot: str) -> ros.DiagnosticStatus:
    """WARN while the last command was refused."""
    if outcomes is None:
        return _status(ros.OK, "commands", robot, "none are taken: no --allow-commands", {})
    values = {
        "accepted": str(outcomes.accepted),
        "refused": str(outcomes.refused),
        "last refusal": outcomes.last_refusal,
    }
    level = ros.WARN if outcomes.refusal else ros.OK
    return _status(level, "commands", robot, outcomes.refusal or "ok", values)


def lost_status(why: str, robot: str) -> ros.DiagnosticStatus:
    """Driver or controller is silent."""
    return _status(ros.STALE, "arm", robot, why, {})


def _status(
    level: int, name: str, robot: str, message: str, values: dict[str, str]
) -> ros.DiagnosticStatus:
    pairs = [ros.KeyValue(key, value) for key, value in values.items()]
    return ros.DiagnosticStatus(level, f"limber: {name}", message, robot, pairs)
