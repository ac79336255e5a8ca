"""What a log's charts show: both the PNG and the interactive page are drawn from this."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from limber import messages
from limber.log.reader import Log, time_s
from limber.model.rotations import rotation_error

AXES = ("x", "y", "z")
QUANTILES = {"p50": "median", "p99": "99 %", "p999": "99.9 %", "max": "greatest"}


@dataclass
class Chart:
    """Lines over time. `t_s` is arm time; every series has one value for each of its entries."""

    title: str
    unit: str
    t_s: np.ndarray
    series: dict[str, np.ndarray] = field(default_factory=dict)
    dashed: set[str] = field(default_factory=set)

    def since(self, begin_s: float) -> "Chart":
        kept = self.t_s >= begin_s
        series = {name: values[kept] for name, values in self.series.items()}
        return replace(self, t_s=self.t_s[kept], series=series)

    def color_numbers(self) -> list[int]:
        """One for each series; "q desired" has the colour of the "q" before it."""
        numbers: list[int] = []
        before = None
        for name in self.series:
            paired = before is not None and name.startswith(f"{before} ")
            numbers.append(numbers[-1] if paired else max(numbers, default=-1) + 1)
            before = name
        return numbers


def build(log: Log, what: str, joint_names: list[str] | None = None) -> list[Chart]:
    """Charts of a topic from the first answer of all drives on, leaving out what the log does not
    hold: none if it holds nothing of it.
    """
    begin_s = _begin_s(log.read("JOINT_STATE"))
    charts = [chart.since(begin_s) for chart in TOPICS[what](log, joint_names or [])]
    return [chart for chart in charts if len(chart.t_s) > 1 and chart.series]


def _begin_s(state: np.ndarray) -> float:
    """When every drive has answered for the first time: before, positions are zeros."""
    fresh = messages.message_class("joint_state_t").JOINT_FRESH
    answered = ((state["joint_flags"][:, : _joint_count(state)] & fresh) != 0).all(axis=1)
    return float(time_s(state)[np.argmax(answered)]) if answered.any() else -np.inf


def _joint_count(records: np.ndarray) -> int:
    return int(records["num_joints"].max(initial=0))


def _labels(count: int, names: list[str]) -> list[str]:
    return [names[i] if i < len(names) else f"joint {i + 1}" for i in range(count)]


def _columns(values: np.ndarray, labels: list[str]) -> dict[str, np.ndarray]:
    return {label: values[:, i] for i, label in enumerate(labels)}


def _joint_charts(log: Log, names: list[str]) -> list[Chart]:
    state = log.read("JOINT_STATE")
    t, labels = time_s(state), _labels(_joint_count(state), names)
    fields = (
        ("q", "joint position", "rad"),
        ("v", "joint velocity", "rad/s"),
        ("tau", "torque the drives report", "N m"),
        ("temperature_degC", "temperature", "°C"),
    )
    return [Chart(title, unit, t, _columns(state[key], labels)) for key, title, unit in fields]


def _cartesian_charts(log: Log, _names: list[str]) -> list[Chart]:
    status, truth = log.read("CONTROLLER_STATUS"), log.read("SIM_TRUTH")
    t = time_s(status)
    position = Chart("tip position", "m", t)
    for i, axis in enumerate(AXES):
        position.series[axis] = status["p_BT"][:, i]
        position.series[f"{axis} desired"] = status["p_BD"][:, i]
        position.dashed.add(f"{axis} desired")
    away_mm = (status["p_BT"] - status["p_BD"]) * 1e3
    turned = rotation_error(status["quat_BT"], status["quat_BD"])
    charts = [
        position,
        Chart("tip away from its goal", "mm", t, _columns(away_mm, list(AXES))),
        Chart("tip turned from its goal", "rad", t, _columns(turned, list(AXES))),
    ]
    if len(truth) and np.any(truth["F_push"][:, 3:]):
        torque = _columns(truth["F_push"][:, 3:], [f"{axis} push" for axis in AXES])
        charts.append(Chart("torque of pushes on the arm", "N m", time_s(truth), torque))
    if len(truth):
        force = Chart("force of walls and pushes on the arm", "N", time_s(truth))
        for i, axis in enumerate(AXES):
            force.series[axis] = truth["F_contact"][:, i]
            force.series[f"{axis} push"] = truth["F_push"][:, i]
            force.dashed.add(f"{axis} push")
        charts.append(force)
    energy = {"kinetic, arm": status["kinetic_energy_J"], "spring": status["spring_energy_J"]}
    return [*charts, Chart("energy", "J", t, energy)]


def _contact_charts(status: np.ndarray) -> list[Chart]:
    t, F_ext, axes = time_s(status), status["F_ext"], list(AXES)
    return [
        Chart("contact force at the tip (controller)", "N", t, _columns(F_ext[:, :3], axes)),
        Chart("contact torque at the tip (controller)", "N m", t, _columns(F_ext[:, 3:], axes)),
    ]


def _torque_charts(log: Log, names: list[str]) -> list[Chart]:
    """The terms of every joint's torque; one chart a joint. Contact, if it has a source."""
    status = log.read("CONTROLLER_STATUS")
    terms = ["stiffness", "damping", "null", "gravity", "coriolis", "friction", "sent"]
    charts = []
    if status["contact"].any():
        terms.append("ext")
        charts = _contact_charts(status)
    for i, label in enumerate(_labels(_joint_count(status), names)):
        series = {term: status[f"tau_{term}"][:, i] for term in terms}
        charts.append(Chart(f"torque of {label}", "N m", time_s(status), series))
    return charts


def _spring_charts(log: Log, names: list[str]) -> list[Chart]:
    """What springs between motor and link do; nothing for arms whose joints show no such sides."""
    state = log.read("JOINT_STATE")
    flags = messages.message_class("joint_state_t")
    t, labels = time_s(state), _labels(_joint_count(state), names)

    def those_with(flag: int) -> list[int]:
        return [i for i in range(len(labels)) if (state["joint_flags"][:, i] & flag).any()]

    def chart(title: str, unit: str, values: np.ndarray, flag: int) -> Chart:
        series = {labels[i]: values[:, i] for i in those_with(flag)}
        return Chart(title, unit, t, series)

    deflection_mrad = (state["theta"] - state["q"]) * 1e3
    torque = Chart("torque on the link", "N m", t)
    for i in those_with(flags.JOINT_TORQUE_SENSOR):
        asked = f"{labels[i]} asked of the motor"
        torque.series[labels[i]] = state["tau"][:, i]
        torque.series[asked] = state["tau_applied"][:, i]
        torque.dashed.add(asked)
    return [
        chart("motor ahead of the link", "mrad", deflection_mrad, flags.JOINT_LINK_ENCODER),
        torque,
        chart("preload of the two motors", "rad", state["preload"], flags.JOINT_TWO_MOTORS),
    ]


def _timing_charts(log: Log, _names: list[str]) -> list[Chart]:
    status, driver = log.read("CONTROLLER_STATUS"), log.read("DRIVER_STATUS")
    state = log.read("JOINT_STATE")
    t = time_s(driver)

    def quantiles(of: str, *names: str) -> dict[str, np.ndarray]:
        return {QUANTILES[name]: driver[f"{of}_{name}_ns"] * 1e-3 for name in names}

    counts = {
        "late cycles": driver["late_cycles"],
        "overruns": driver["overrun_cycles"],
        "cycles without answer": driver["commands_missing"],
        "commands refused": driver["commands_refused"][:, 1:].sum(axis=1),
        "replies lost": driver["replies_lost"].sum(axis=1),
    }
    buses = int(driver["num_buses"].max(initial=0))
    load = {f"bus {i + 1}": driver["bus_load_counted"][:, i] * 100 for i in range(buses)}
    counted = [Chart("counted so far", "cycles", t, counts), Chart("bus load", "%", t, load)]
    if len(driver) and driver[-1]["lockstep"]:  # no clock: nothing is early or late
        return counted
    loop = {"controller cycle": status["cycle_ns"] * 1e-3}
    step = np.diff(state["time_ns"], prepend=state["time_ns"][:1]) * 1e-6
    return [
        Chart("time from state to state", "ms", time_s(state), {"step": step}),
        Chart("lateness of the cycle, so far", "µs", t, quantiles("lateness", *QUANTILES)),
        Chart("state to torque, so far", "µs", t, quantiles("answer", "p50", "p99", "max")),
        Chart("controller's own time", "µs", time_s(status), loop),
        *counted,
    ]


SOURCES = {
    "joint": ("JOINT_STATE",),
    "cartesian": ("CONTROLLER_STATUS", "SIM_TRUTH"),
    "torque": ("CONTROLLER_STATUS",),
    "spring": ("JOINT_STATE of arms with link encoders, torque sensors or two motors a joint",),
    "timing": ("JOINT_STATE", "DRIVER_STATUS", "CONTROLLER_STATUS"),
}
TOPICS: dict[str, Callable[[Log, list[str]], list[Chart]]] = {
    "joint": _joint_charts,
    "cartesian": _cartesian_charts,
    "torque": _torque_charts,
    "spring": _spring_charts,
    "timing": _timing_charts,
}
