"""What a log's charts show: both the PNG and the interactive page are drawn from this."""

from collections.abc import Callable

import numpy as np

from limber.arrays import Flags, Floats
from limber.log.reader import time_s
from limber.log.rows import active
from limber.messages import message_class
from limber.model.gains_table import acts_at_joints, law_names
from limber.model.rotations import rotation_error
from limber.plot.chart import Chart, Messages
from limber.plot.compliance import compliance_charts

AXES = ("x", "y", "z")
OVERVIEW = (
    "tip away from its goal",
    "tip behind the springs away from its goal",
    "force of walls and pushes on the arm",
    "torque of pushes on the arm",
)
SPRINGS_FROM_RAD = 1e-4
TAIL_TITLE, TAIL_X = "share of cycles that take longer", "time (µs)"
LATER, OWN_TIME = "state later than its period", "controller's own time"
SHORT = 0.1  # share of the run that a law is too short for to count
TERMS = {  # tau_TERM of CONTROLLER_STATUS, in the words of all pictures
    "stiffness": "spring",
    "damping": "damper",
    "null": "posture",
    "gravity": "gravity",
    "coriolis": "Coriolis",
    "friction": "friction",
}
QUANTILES = {"p50": "median", "p99": "99 %", "p999": "99.9 %", "max": "greatest"}


def build(log: Messages, what: str, joint_names: list[str] | None = None) -> list[Chart]:
    """Charts of a topic from the first answer of all drives on, leaving out what the log does not
    hold: none if it holds nothing of it.
    """
    begin = begin_s(log)
    charts = [chart.since(begin) for chart in TOPICS[what](log, joint_names or [])]
    return [chart for chart in charts if len(chart.t_s) > 1 and chart.series]


def begin_s(log: Messages) -> float:
    """When every drive has answered for the first time: before, positions are zeros."""
    state = log.read("JOINT_STATE")
    fresh = message_class("joint_state_t").JOINT_FRESH
    answered = ((state["joint_flags"][:, : _joint_count(state)] & fresh) != 0).all(axis=1)
    return float(time_s(state)[np.argmax(answered)]) if answered.any() else -np.inf


def is_pose(quat: Floats) -> Flags:
    """Which of the quaternions, n x 4, are one: before there is a pose they are zeros."""
    poses: Flags = np.linalg.norm(quat, axis=1) > 0.5
    return poses


def _joint_count(records: np.ndarray) -> int:
    return int(records["num_joints"].max(initial=0))


def _labels(count: int, names: list[str]) -> list[str]:
    return [names[i] if i < len(names) else f"joint {i + 1}" for i in range(count)]


def _columns(values: np.ndarray, labels: list[str]) -> dict[str, np.ndarray]:
    return {label: values[:, i] for i, label in enumerate(labels)}


def _joint_charts(log: Messages, names: list[str]) -> list[Chart]:
    state = log.read("JOINT_STATE")
    t, labels = time_s(state), _labels(_joint_count(state), names)
    fields = (
        ("q", "joint position", "rad", 0.0),
        ("v", "joint velocity", "rad/s", 0.05),
        ("tau", "torque the drives report", "N m", 0.5),
        ("temperature_degC", "temperature", "°C", 0.0),
    )
    return [
        Chart(title, unit, t, _columns(state[key], labels), least=least)
        for key, title, unit, least in fields
    ]


def _overview_charts(log: Messages, names: list[str]) -> list[Chart]:
    """What was asked for, what came of it, and what acted on the arm."""
    status = log.read("CONTROLLER_STATUS")
    t, n = time_s(status), _joint_count(status)
    moved = [chart for chart in _cartesian_charts(log, names) if chart.title in OVERVIEW]
    K_x, K_q = np.diagonal(status["K_x"], axis1=1, axis2=2)[:, :3], status["K_q"][:, :n]
    laws = law_names()
    ran, cycles = np.unique(status["law"][active(status)], return_counts=True)
    ran = ran[cycles > SHORT * cycles.sum()]
    at_joints = {acts_at_joints(laws[law]) for law in ran if 0 <= law < len(laws)}
    stiffness = []
    if False in at_joints and K_x.any():
        stiffness.append(Chart("K_x in effect", "N/m", t, _columns(K_x, list(AXES)), zero=True))
    if True in at_joints and K_q.any():
        of_joints = _columns(K_q, _labels(n, names))
        stiffness.append(Chart("K_q in effect", "N m/rad", t, of_joints, zero=True))
    sent = _columns(status["tau_sent"], _labels(n, names))
    torque = Chart("torque sent to the joints", "N m", t, sent, least=0.5)
    hand = _hand_charts(log, names)[:2] if len(log.read("HAND_STATE")) else []
    return [*moved, *stiffness, torque, *compliance_charts(log), *hand]


def _cartesian_charts(log: Messages, _names: list[str]) -> list[Chart]:
    all_status, truth = log.read("CONTROLLER_STATUS"), log.read("SIM_TRUTH")
    status = all_status[is_pose(all_status["quat_BT"])]  # from the tip's start
    t, wanted = time_s(status), is_pose(status["quat_BD"])
    p_BD = np.where(wanted[:, None], status["p_BD"], np.nan)
    position = Chart("tip position", "m", t)
    for i, axis in enumerate(AXES):
        position.series[axis] = status["p_BT"][:, i]
        position.series[f"{axis} desired"] = p_BD[:, i]
        position.dashed.add(f"{axis} desired")
    away_mm = (status["p_BT"] - p_BD) * 1e3
    turned = np.full((len(status), 3), np.nan)
    turned[wanted] = rotation_error(status["quat_BT"][wanted], status["quat_BD"][wanted])
    charts = [
        position,
        Chart("tip away from its goal", "mm", t, _columns(away_mm, list(AXES)), least=1.0),
        Chart("tip turned from its goal", "rad", t, _columns(turned, list(AXES)), least=0.01),
    ]
    charts += _link_charts(all_status, truth)
    if len(truth) and np.any(truth["F_push"][:, 3:]):
        torque = _columns(truth["F_push"][:, 3:], [f"{axis} push" for axis in AXES])
        charts.append(Chart("torque of pushes on the arm", "N m", time_s(truth), torque, least=0.1))
    if len(truth):
        force = Chart("force of walls and pushes on the arm", "N", time_s(truth), least=1.0)
        for i, axis in enumerate(AXES):
            force.series[axis] = truth["F_contact"][:, i]
            force.series[f"{axis} push"] = truth["F_push"][:, i]
            force.dashed.add(f"{axis} push")
        charts.append(force)
    energy = {"kinetic, arm": status["kinetic_energy_J"], "spring": status["spring_energy_J"]}
    return [*charts, Chart("energy", "J", t, energy, least=0.01)]


def _link_charts(status: np.ndarray, truth: np.ndarray) -> list[Chart]:
    """Where joints have springs, the tip is not where the motors are: the simulator knows it."""
    n = _joint_count(truth)
    bend = np.abs(truth["theta"][:, :n] - truth["q"][:, :n]).max(initial=0.0)
    known = status[status["mode"] > message_class("controller_status_t").MODE_INIT]
    if bend < SPRINGS_FROM_RAD or not len(known):
        return []
    truth = truth[time_s(truth) >= time_s(known)[0]]
    t = time_s(truth)
    goal = np.column_stack([np.interp(t, time_s(known), g) for g in known["p_BD"].T])
    away_mm = (truth["p_BT"] - goal) * 1e3
    return [
        Chart(
            "tip behind the springs away from its goal",
            "mm",
            t,
            _columns(away_mm, list(AXES)),
            least=1.0,
        )
    ]


def _contact_charts(status: np.ndarray) -> list[Chart]:
    t, F_ext, axes = time_s(status), status["F_ext"], list(AXES)
    return [
        Chart(
            "contact force at the tip (controller)", "N", t, _columns(F_ext[:, :3], axes), least=1.0
        ),
        Chart(
            "contact torque at the tip (controller)",
            "N m",
            t,
            _columns(F_ext[:, 3:], axes),
            least=0.1,
        ),
    ]


def _torque_charts(log: Messages, names: list[str]) -> list[Chart]:
    """The terms of every joint's torque on top of each other; one chart a joint. Contact, if it has
    a source.
    """
    status = log.read("CONTROLLER_STATUS")
    names_of = {**TERMS, "sent": "sent"}
    charts = []
    if status["contact"].any():
        names_of["ext"] = "contact"
        charts = _contact_charts(status)
    for i, label in enumerate(_labels(_joint_count(status), names)):
        series = {name: status[f"tau_{term}"][:, i] for term, name in names_of.items()}
        title, stacked = f"torque of {label}", set(TERMS.values())
        charts.append(Chart(title, "N m", time_s(status), series, stacked=stacked, least=0.5))
    return charts


def _spring_charts(log: Messages, names: list[str]) -> list[Chart]:
    """What springs between motor and link do; nothing for arms whose joints show no such sides."""
    state = log.read("JOINT_STATE")
    flags = message_class("joint_state_t")
    t, labels = time_s(state), _labels(_joint_count(state), names)

    def those_with(flag: int) -> list[int]:
        return [i for i in range(len(labels)) if (state["joint_flags"][:, i] & flag).any()]

    def chart(title: str, unit: str, values: np.ndarray, flag: int, least: float) -> Chart:
        series = {labels[i]: values[:, i] for i in those_with(flag)}
        return Chart(title, unit, t, series, least=least)

    deflection_mrad = (state["theta"] - state["q"]) * 1e3
    torque = Chart("torque on the link", "N m", t, least=0.5)
    for i in those_with(flags.JOINT_TORQUE_SENSOR):
        asked = f"{labels[i]} asked of the motor"
        torque.series[labels[i]] = state["tau"][:, i]
        torque.series[asked] = state["tau_applied"][:, i]
        torque.dashed.add(asked)
    return [
        chart("motor ahead of the link", "mrad", deflection_mrad, flags.JOINT_LINK_ENCODER, 1.0),
        torque,
        chart("preload of the two motors", "rad", state["preload"], flags.JOINT_TWO_MOTORS, 0.01),
    ]


def _timing_charts(log: Messages, _names: list[str]) -> list[Chart]:
    """Nothing in lock step: without a clock nothing is early or late."""
    status, driver = log.read("CONTROLLER_STATUS"), log.read("DRIVER_STATUS")
    state = log.read("JOINT_STATE")
    t = time_s(driver)
    if len(driver) and driver[-1]["lockstep"]:
        return []

    def quantiles(of: str, *names: str) -> dict[str, np.ndarray]:
        return {QUANTILES[name]: driver[f"{of}_{name}_ns"] * 1e-3 for name in names}

    loop = {"controller cycle": status["cycle_ns"] * 1e-3}
    step = np.diff(state["time_ns"], prepend=state["time_ns"][:1]) * 1e-6
    counts = {"late cycles": driver["late_cycles"], "overruns": driver["overrun_cycles"]}
    return [
        Chart("time from state to state", "ms", time_s(state), {"step": step}),
        Chart(
            "lateness of the cycle, so far", "µs", t, quantiles("lateness", *QUANTILES), zero=True
        ),
        Chart(
            "state to torque, so far", "µs", t, quantiles("answer", "p50", "p99", "max"), zero=True
        ),
        Chart(OWN_TIME, "µs", time_s(status), loop, zero=True),
        Chart("late, counted so far", "cycles", t, counts, zero=True),
        *_tail(step[1:], status["cycle_ns"]),
    ]


def _tail(step_ms: np.ndarray, cycle_ns: np.ndarray) -> list[Chart]:
    """How seldom a cycle takes longer than x: the tail that averages hide."""
    if len(step_ms) < 2 or len(cycle_ns) < 2:
        return []
    late_us = np.maximum(step_ms - np.median(step_ms), 0.0) * 1e3
    x = np.geomspace(1.0, max(late_us.max(), cycle_ns.max() * 1e-3, 10.0), 200)
    seldom = {
        LATER: np.array([(late_us > value).mean() for value in x]),
        OWN_TIME: np.array([(cycle_ns * 1e-3 > value).mean() for value in x]),
    }
    shown = {n: np.where(share > 0, share, np.nan) for n, share in seldom.items() if share.any()}
    if not shown:
        return []
    return [Chart(TAIL_TITLE, "1", x, shown, x=TAIL_X, log=True)]


def _bus_charts(log: Messages, _names: list[str]) -> list[Chart]:
    driver = log.read("DRIVER_STATUS")
    t, n = time_s(driver), _joint_count(driver)
    buses = [f"bus {i + 1}" for i in range(int(driver["num_buses"].max(initial=0)))]
    counts = {
        "cycles without answer": driver["commands_missing"],
        "commands refused": driver["commands_refused"][:, 1:].sum(axis=1),
        "replies lost": driver["replies_lost"][:, :n].sum(axis=1),
        "replies late": driver["replies_late"][:, :n].sum(axis=1),
    }
    load = _columns(driver["bus_load_counted"] * 100, buses)
    return [
        Chart("bus load", "%", t, load, zero=True),
        Chart("counted so far", "cycles", t, counts, zero=True),
        Chart(
            "error frames so far", "frames", t, _columns(driver["error_frames"], buses), zero=True
        ),
    ]


def _hand_charts(log: Messages, _names: list[str]) -> list[Chart]:
    """Nothing for an arm without a hand."""
    hand, truth = log.read("HAND_STATE"), log.read("HAND_TRUTH")
    t = time_s(hand)
    width = {"width": hand["width_m"] * 1e3, "aimed at": hand["target_m"] * 1e3}
    width["goal"] = hand["goal_width_m"] * 1e3
    force = {"by the motor": hand["force_N"], "allowed": hand["force_bound_N"]}
    flags = {word: hand[word].astype(float) for word in ("grasped", "moving", "warm")}
    charts = [
        Chart("width of the hand", "mm", t, width, dashed={"aimed at", "goal"}, zero=True),
        Chart("force of each finger", "N", t, force, dashed={"allowed"}, least=1.0),
        Chart(
            "heat of the hand's motor", "1", t, {"of the rated torque's": hand["heat"]}, zero=True
        ),
        Chart("the hand", "1", t, flags, zero=True),
    ]
    count = int(truth["num_objects"].max(initial=0))
    if count:
        lifted = (truth["p_BO"][:, :count, 2] - truth["p_BO"][:1, :count, 2]) * 1e3
        objects = _columns(lifted, [f"object {i + 1}" for i in range(count)])
        charts.append(
            Chart("objects above where they lay (z)", "mm", time_s(truth), objects, least=1.0)
        )
    return charts


SOURCES = {
    "overview": ("CONTROLLER_STATUS", "SIM_TRUTH"),
    "joint": ("JOINT_STATE",),
    "cartesian": ("CONTROLLER_STATUS", "SIM_TRUTH"),
    "torque": ("CONTROLLER_STATUS",),
    "spring": ("JOINT_STATE of arms with link encoders, torque sensors or two motors a joint",),
    "timing": ("JOINT_STATE, DRIVER_STATUS and CONTROLLER_STATUS of a run that had a clock",),
    "bus": ("DRIVER_STATUS",),
    "hand": ("HAND_STATE of an arm with a hand",),
}
TOPICS: dict[str, Callable[[Messages, list[str]], list[Chart]]] = {
    "overview": _overview_charts,
    "joint": _joint_charts,
    "cartesian": _cartesian_charts,
    "torque": _torque_charts,
    "spring": _spring_charts,
    "timing": _timing_charts,
    "bus": _bus_charts,
    "hand": _hand_charts,
}
