"""Whether a run went as it should, apart from its physics: cycles, losses, refusals, faults."""

import numpy as np

from limber import messages
from limber.logs import Log
from limber.results import Result, at_most
from limber.scenario import Scenario


def health_results(log: Log, scenario: Scenario, recorder_lost: dict[str, int]) -> list[Result]:
    state, driver = log.read("JOINT_STATE"), log.read("DRIVER_STATUS")
    results = [Result("cycles", len(state))]
    realtime = len(driver) and not driver[-1]["lockstep"]
    results.append(_lost(log, recorder_lost, skipped={"JOINT_TORQUE"} if realtime else set()))
    if len(driver):
        results.extend(_driver(driver[-1], scenario))
    results.append(_faults(state, scenario))
    return results


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
    if not scenario.faults:
        results.append(at_most("replies lost on the bus", replies, "", 0))
    if status["lockstep"]:
        return results
    note = f"of {cycles}; started more than a tenth of a period late"
    return [
        *results,
        Result("late cycles", int(status["late_cycles"]), note=note),
        Result("overruns", int(status["overrun_cycles"]), note="took longer than the period"),
        Result("lateness, median", float(status["lateness_p50_ns"]) * 1e-3, "µs"),
        Result("lateness, 99 %", float(status["lateness_p99_ns"]) * 1e-3, "µs"),
        Result("state to torque, median", float(status["answer_p50_ns"]) * 1e-3, "µs"),
        Result("state to torque, 99 %", float(status["answer_p99_ns"]) * 1e-3, "µs"),
        Result("realtime granted", bool(status["realtime_priority"])),
    ]


def _faults(state: np.ndarray, scenario: Scenario) -> Result:
    """Faults that a scenario or the operator asked for are told, not judged."""
    names = messages.constants("joint_state_t", "FAULT_")
    seen = [names.get(int(value), str(value)) for value in np.unique(state["fault"]) if value]
    passed = None if scenario.faults or seen == ["REQUESTED"] else not seen
    return Result("faults", ", ".join(seen) or "none", asked="none", passed=passed)
