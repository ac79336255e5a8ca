"""Whether a run went as it should, apart from its physics: cycles, losses, refusals, faults."""

import numpy as np

from limber import messages
from limber.log.reader import Log
from limber.measure.results import Result, at_most
from limber.measure.sound import damaged
from limber.model.scenario import Scenario


def health_results(log: Log, scenario: Scenario, recorder_lost: dict[str, int]) -> list[Result]:
    state, driver = log.read("JOINT_STATE"), log.read("DRIVER_STATUS")
    results = [Result("cycles", len(state))]
    realtime = len(driver) and not driver[-1]["lockstep"]
    results.append(_lost(log, recorder_lost, skipped={"JOINT_TORQUE"} if realtime else set()))
    if len(driver):
        results.extend(_driver(driver[-1], scenario))
    results.append(_faults(state, log.read("CONTROLLER_STATUS"), scenario))
    return results + _unsound(log)


def _unsound(log: Log) -> list[Result]:
    """A damaged log, or a simulation that has diverged: such a run never passes."""
    count = sum(damaged(log.read(channel)) for channel in ("SIM_TRUTH", "CONTROLLER_STATUS"))
    return [at_most("messages with impossible numbers", count, "", 0)] if count else []


def _lost(log: Log, recorder_lost: dict[str, int], skipped: set[str]) -> Result:
    """`skipped`: channels whose gaps are no loss. In realtime a controller that was held up answers
    the newest state only; the driver counts the others as cycles without an answer.
    """
    lost = {name: log.lost(name) for name in log.channels if name not in skipped}
    for name, count in recorder_lost.items():
        if name in lost:
            lost[name] = max(lost[name], count)
    where = ", ".join(f"{name} {count}" for name, count in lost.items() if count)
    return at_most("messages lost", sum(lost.values()), "", 0, where)


def _driver(status: np.void, scenario: Scenario) -> list[Result]:
    cycles = int(status["cycles"])
    verdicts = messages.constants("driver_status_t", "VERDICT_")
    refused = {name: int(status["commands_refused"][i]) for i, name in verdicts.items() if i}
    why = ", ".join(f"{name} {count}" for name, count in refused.items() if count)
    replies = int(status["replies_lost"].sum())
    results = [
        Result("cycles without an answer", int(status["commands_missing"])),
        at_most("commands refused", sum(refused.values()), "", 0, why),
    ]
    lost = "replies lost on the bus"
    if status["lockstep"]:
        judged = Result(lost, replies) if scenario.faults else at_most(lost, replies, "", 0)
        return [*results, judged]
    note = f"of {cycles}; started more than a tenth of a period late"
    return [
        *results,
        Result(lost, replies),
        Result("late cycles", int(status["late_cycles"]), note=note),
        Result("overruns", int(status["overrun_cycles"]), note="took longer than the period"),
        Result("lateness, median", float(status["lateness_p50_ns"]) * 1e-3, "µs"),
        Result("lateness, 99 %", float(status["lateness_p99_ns"]) * 1e-3, "µs"),
        Result("state to torque, median", float(status["answer_p50_ns"]) * 1e-3, "µs"),
        Result("state to torque, 99 %", float(status["answer_p99_ns"]) * 1e-3, "µs"),
        Result("realtime granted", bool(status["realtime_priority"])),
    ]


def _faults(state: np.ndarray, status: np.ndarray, scenario: Scenario) -> Result:
    """The driver's and the controller's, until the scenario is over and the drives are shut down.
    Faults that the scenario or an operator requested are not judged.
    """
    end_ns = scenario.duration_s * 1e9
    state, status = state[state["time_ns"] < end_ns], status[status["time_ns"] < end_ns]
    seen = _names("joint_state_t", "FAULT_", state["fault"])
    in_fault = status["mode"] == messages.message_class("controller_status_t").MODE_FAULT
    seen += _names("controller_status_t", "REASON_", status["reason"][in_fault])
    passed = None if scenario.faults or seen == ["REQUESTED"] else not seen
    return Result("faults", ", ".join(seen) or "none", expected="none", passed=passed)


def _names(type_name: str, prefix: str, values: np.ndarray) -> list[str]:
    names = messages.constants(type_name, prefix)
    return [names.get(int(value), str(value)) for value in np.unique(values) if value]
