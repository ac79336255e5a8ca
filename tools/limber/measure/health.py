"""Whether a run went as it should, apart from its physics: cycles, losses, refusals, faults."""

from typing import Any

import numpy as np

from limber import messages
from limber.log.reader import Log, time_s
from limber.measure.faults import Fault
from limber.measure.results import Result, at_most
from limber.measure.sound import damaged
from limber.model.scenario import Scenario
from limber.problems import problem

LOST_REPLIES = "replies lost on the bus"


def health_results(
    log: Log,
    scenario: Scenario,
    recorder_lost: dict[str, int],
    recorder_dropped: int,
    faults: list[Fault],
) -> list[Result]:
    state, driver = log.read("JOINT_STATE"), log.read("DRIVER_STATUS")
    results = [Result("cycles", len(state))]
    realtime = len(driver) and not driver[-1]["lockstep"]
    skipped = {"JOINT_TORQUE"} if realtime else set()
    results.append(_lost(log, recorder_lost, recorder_dropped, skipped))
    if len(driver):
        results.extend(_driver(driver[-1], scenario))
    results.append(_requests(log, log.read("CONTROLLER_STATUS")))
    results.append(_faults(faults, scenario))
    return results + _unsound(log)


def _unsound(log: Log) -> list[Result]:
    """A damaged log, or a simulation that has diverged: such a run never passes."""
    count = sum(damaged(log.read(channel)) for channel in ("SIM_TRUTH", "CONTROLLER_STATUS"))
    return [at_most("messages with impossible numbers", count, "", 0)] if count else []


def _lost(
    log: Log, recorder_lost: dict[str, int], recorder_dropped: int, skipped: set[str]
) -> Result:
    """`skipped`: channels whose gaps are no loss. In realtime a controller that was held up answers
    the newest state only; the driver counts the others as cycles without an answer.

    What the kernel dropped before the recorder is known of all channels together.
    """
    lost = {name: log.lost(name) for name in log.channels if name not in skipped}
    for name, count in recorder_lost.items():
        if name in lost:
            lost[name] = max(lost[name], count)
    where = [f"{name} {count}" for name, count in lost.items() if count]
    more = max(recorder_dropped - sum(lost.values()), 0)
    if more:
        where.append(f"{more} more before the recorder")
    return at_most("messages lost", sum(lost.values()) + more, "", 0, ", ".join(where))


def _driver(status: np.void, scenario: Scenario) -> list[Result]:
    cycles = int(status["cycles"])
    refused = {
        cause.code: int(count)
        for verdict, count in enumerate(status["commands_refused"])
        if count and (cause := problem("gate", verdict)) is not None
    }
    why = ", ".join(f"{code} {count}" for code, count in refused.items())
    replies = int(status["replies_lost"].sum())
    results = [
        Result("cycles without an answer", int(status["commands_missing"])),
        at_most("commands refused", sum(refused.values()), "", 0, why),
    ]
    unjudged = Result(LOST_REPLIES, replies)
    if status["lockstep"]:
        return [*results, unjudged if scenario.faults else at_most(LOST_REPLIES, replies, "", 0)]
    note = f"of {cycles}; started more than a tenth of a period late"
    return [
        *results,
        unjudged,
        Result("late cycles", int(status["late_cycles"]), note=note),
        Result("overruns", int(status["overrun_cycles"]), note="took longer than the period"),
        Result("lateness, median", float(status["lateness_p50_ns"]) * 1e-3, "µs"),
        Result("lateness, 99 %", float(status["lateness_p99_ns"]) * 1e-3, "µs"),
        Result("state to torque, median", float(status["answer_p50_ns"]) * 1e-3, "µs"),
        Result("state to torque, 99 %", float(status["answer_p99_ns"]) * 1e-3, "µs"),
        Result("realtime granted", bool(status["realtime_priority"])),
    ]


def _faults(faults: list[Fault], scenario: Scenario) -> Result:
    """Faults that the scenario requested are not judged."""
    passed = None if scenario.faults else not faults
    codes = dict.fromkeys(code for fault in faults for code in (fault.problem.code, *fault.also))
    if any(code.startswith("driver.") for code in codes):
        codes.pop("controller.DRIVER_FAULT", None)  # its consequence
    note = "; ".join(fault.title.partition(" ")[2] for fault in faults)
    return Result("faults", ", ".join(codes) or "none", expected="none", passed=passed, note=note)


def _requests(log: Log, status: np.ndarray) -> Result:
    """Those of the scenario are judged: nobody else was told of them."""
    kinds = messages.constants("request_answer_t", "KIND_")
    answers = [answer for answer in log.decode("REQUEST_ANSWER") if not answer.accepted]
    own = [answer for answer in answers if answer.client == messages.SCENARIO_CLIENT]
    notes = [_refusal(answer, kinds) for answer in own]
    if len(answers) > len(own):
        notes.append(f"{len(answers) - len(own)} of other clients, who were told")
    unheard = int(status["requests_refused"].max(initial=0)) - len(answers)
    if unheard > 0:
        notes.append(f"{unheard} more, whose answers are not in the log")
    return at_most("requests refused", len(own) + max(unheard, 0), "", 0, "; ".join(notes))


def _refusal(answer: Any, kinds: dict[int, str]) -> str:
    cause = problem("request", answer.code)
    code = f"{cause.code}: " if cause else ""
    kind = kinds.get(answer.kind, "request").lower()
    return f"{kind} at {answer.time_ns * 1e-9:.3g} s: {code}{answer.reason}"


def stopped_s(log: Log) -> float:
    """When the driver, told to end, let the drives brake; the log's end if they were off."""
    state = log.read("JOINT_STATE")
    if not len(state):
        return 0.0
    kinds = messages.message_class("joint_state_t")
    t = time_s(state)
    braking = state["drive_state"] == kinds.DRIVE_DAMP
    begins = np.flatnonzero(braking & ~np.concatenate([[False], braking[:-1]]))
    if not len(begins) or state["fault"][begins[-1]] != kinds.FAULT_REQUESTED:
        return float(t[-1])
    after = state["drive_state"][begins[-1] :]
    on_again = np.isin(after, (kinds.DRIVE_ENABLING, kinds.DRIVE_ON, kinds.DRIVE_HOLD)).any()
    return float(t[-1]) if on_again else float(t[begins[-1]])
