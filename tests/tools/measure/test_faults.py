"""Faults, refusals and endings in the result of a run, from logs made of known numbers."""

import numpy as np
import pytest
from made_logs import event_bytes, records, write_log

from limber.log.reader import Log
from limber.measure.faults import find_faults
from limber.measure.summarize import measure
from limber.messages import SCENARIO_CLIENT, message_class

State = message_class("joint_state_t")
Status = message_class("controller_status_t")
Answer = message_class("request_answer_t")
RATE_HZ, SECONDS = 1000, 4
PUSHES = """friction: false
duration_s: 4
timeline:
  - {at_s: 0.5, push: {force_N: [8, 0, 0], ramp_s: 0.1, for_s: 0.6}}
  - {at_s: 3.0, push: {force_N: [8, 0, 0], ramp_s: 0.1, for_s: 0.6}}
"""


@pytest.fixture
def run(scenario):
    return scenario("planar2r", PUSHES)


def state_of(**fields) -> np.ndarray:
    count = SECONDS * RATE_HZ
    time_ns = np.arange(count) * (10**9 // RATE_HZ)
    return records(
        "joint_state_t", count, time_ns=time_ns, num_joints=2, drive_state=State.DRIVE_ON, **fields
    )


def status_of() -> np.ndarray:
    count = SECONDS * RATE_HZ // 5
    made = records("controller_status_t", count, mode=Status.MODE_ACTIVE)
    made["time_ns"] = np.arange(count) * (5 * 10**9 // RATE_HZ)
    made["quat_BT"][:, 0] = 1
    return made


def truth_of() -> np.ndarray:
    """The tip gives way by the 500 N/m of the robot's K_x, whenever it is pushed."""
    count = SECONDS * RATE_HZ
    t = np.arange(count) / RATE_HZ
    truth = records("sim_truth_t", count, num_joints=2, time_ns=np.round(t * 1e9).astype(np.int64))
    truth["q"][:, :2] = 0.5, 1.0
    truth["quat_BT"][:, 0] = 1
    for at_s in (0.5, 3.0):
        inside = np.clip(np.minimum(t - at_s, at_s + 0.6 - t) / 0.1, 0, 1)
        truth["F_push"][:, 0] += 8 * inside
        truth["p_BT"][:, 0] += 8 / 500 * inside
    return truth


def too_fast(state: np.ndarray, status: np.ndarray, at_s: float = 2.0) -> None:
    """The elbow reaches 34 rad/s at 2 s; the drives brake it until 2.25 s."""
    row = int(at_s * RATE_HZ)
    state["v"][row - 2 : row, 1] = 31, 33
    state["v"][row : row + 250, 1] = np.linspace(34, 0.1, 250)
    state["q"][row:, 1] = 0.25
    state["q"][row, 1] = 0.0
    state["fault"][row:], state["fault_joint"][row:] = State.FAULT_VELOCITY, 1
    state["drive_state"][row:] = State.DRIVE_DAMP
    status["mode"][row // 5 + 1 :] = Status.MODE_FAULT
    status["reason"][row // 5 + 1 :] = Status.REASON_DRIVER_FAULT


def log_of(path, answers=(), **channels) -> Log:
    write_log(path, channels)
    with open(path, "ab") as file:
        for answer in answers:
            file.write(event_bytes("REQUEST_ANSWER", answer.encode()))
    return Log(path)


def test_a_fault_has_time_joint_number_limit_and_consequence(tmp_path, run):
    state, status = state_of(), status_of()
    too_fast(state, status)
    log = log_of(tmp_path / "log", JOINT_STATE=state, CONTROLLER_STATUS=status)
    (fault,) = find_faults(log, run.robot, end_s=SECONDS)
    assert fault.title == "driver.VELOCITY at 2.000 s, elbow: 34 rad/s, limit 30 rad/s"
    assert fault.also == ("controller.DRIVER_FAULT",)
    assert "drives DAMP at once; controller FAULT after 0.005 s; " in fault.then
    assert "the arm at rest after 0.25 s; no joint moved by more than 0.25 rad" in fault.then
    assert np.isinf(fault.until_s)


def test_motion_counts_from_the_first_reading_on(tmp_path, run):
    """A joint that has not been read yet is at 0 in the messages, and has not moved from there."""
    state, status = state_of(), status_of()
    status["mode"][:] = Status.MODE_INIT
    never = np.iinfo(np.int32).max
    state["fault"][:], state["fault_joint"][:] = State.FAULT_CONFIGURATION, 1
    state["drive_state"][:] = State.DRIVE_FAULT
    state["age_cycles"][:] = never
    state["q"][:] = -12.5
    state["age_cycles"][1000:, 0] = 0
    state["q"][1000:, 0] = 0.5
    state["q"][3000:, 0] = 0.52
    log = log_of(tmp_path / "log", JOINT_STATE=state, CONTROLLER_STATUS=status)
    (fault, *_) = find_faults(log, run.robot, end_s=SECONDS)
    assert "no joint moved by more than 0.02 rad or m" in fault.then


def test_a_drive_that_never_replied_is_told_as_such(tmp_path, run):
    never = np.iinfo(np.int32).max
    for age, said in ((3, "no reply for 3 cycles"), (never, "no reply since the start")):
        state = state_of()
        state["fault"][:], state["fault_joint"][:] = State.FAULT_REPLY_LOST, 1
        state["drive_state"][:] = State.DRIVE_FAULT
        state["age_cycles"][:, 1] = age
        log = log_of(tmp_path / f"{age}", JOINT_STATE=state, CONTROLLER_STATUS=status_of())
        (fault, *_) = find_faults(log, run.robot, end_s=SECONDS)
        assert fault.title.endswith(f"elbow: {said}")


def test_a_hot_drive_is_told_with_its_limit(tmp_path, run):
    state = state_of()
    state["temperature_degC"][:, 1] = 66
    state["fault"][2000:], state["fault_joint"][2000:] = State.FAULT_TEMPERATURE, 1
    state["drive_state"][2000:] = State.DRIVE_HOLD
    log = log_of(tmp_path / "log", JOINT_STATE=state, CONTROLLER_STATUS=status_of())
    (fault,) = find_faults(log, run.robot, end_s=SECONDS)
    assert fault.title == "driver.TEMPERATURE at 2.000 s, elbow: 66 degC, limit 65 degC"
    assert "support the arm" in fault.problem.remedy


def test_what_is_measured_after_a_fault_is_not_judged(tmp_path, run):
    state, status, truth = state_of(), status_of(), truth_of()
    truth["p_BT"][truth["time_ns"] > 2.5e9, 0] *= 3  # in DAMP the arm is no spring
    too_fast(state, status)
    log = log_of(tmp_path / "log", JOINT_STATE=state, CONTROLLER_STATUS=status, SIM_TRUTH=truth)
    summary = measure(log, run, "lab")[0]
    before, after = (result for result in summary.results if result.name == "stiffness +x")
    assert before.passed is True
    assert after.passed is None and after.note == "after the fault"
    assert summary.find("faults").value == "driver.VELOCITY", "not its consequence as well"
    assert not summary.passed


def test_a_fault_that_was_acknowledged_is_over(tmp_path, run):
    state, status, truth = state_of(), status_of(), truth_of()
    too_fast(state, status)
    state["fault"][2500:], state["drive_state"][2500:] = 0, State.DRIVE_ON
    status["mode"][510:], status["reason"][510:] = Status.MODE_ACTIVE, 0
    log = log_of(tmp_path / "log", JOINT_STATE=state, CONTROLLER_STATUS=status, SIM_TRUTH=truth)
    summary = measure(log, run, "lab")[0]
    assert summary.faults[0].until_s == pytest.approx(2.55)
    judged = [result.passed for result in summary.results if result.name == "stiffness +x"]
    assert judged == [True, True]


def test_a_controllers_fault_is_told_with_its_own_number(tmp_path, run):
    state, status = state_of(), status_of()
    state["drive_state"][:300] = State.DRIVE_OFF
    state["theta"][:, 0] = np.where(np.arange(len(state)) < 250, 0.5, 0.0)  # it sank meanwhile
    state["theta"][700:, 0] = 0.104
    status["mode"][140:] = Status.MODE_FAULT
    status["reason"][140:], status["reason_joint"][140:] = Status.REASON_STRAYED, 0
    log = log_of(tmp_path / "log", JOINT_STATE=state, CONTROLLER_STATUS=status)
    (fault,) = find_faults(log, run.robot, end_s=SECONDS)
    assert fault.problem.code == "controller.STRAYED"
    assert fault.title.endswith("shoulder: moved by 0.104 rad since the drives came on")


def test_a_motor_that_makes_a_multiple_is_told_with_the_factor(tmp_path, run):
    state, status = state_of(), status_of()
    weight_Nm = run.robot.dynamics.gravity_torque(state["q"][-1:, :2])[0][1]
    state["tau_applied"][:, 1] = weight_Nm / 4.0
    status["mode"][140:] = Status.MODE_FAULT
    status["reason"][140:], status["reason_joint"][140:] = Status.REASON_OVERDRIVEN, 1
    log = log_of(tmp_path / "log", JOINT_STATE=state, CONTROLLER_STATUS=status)
    (fault,) = find_faults(log, run.robot, end_s=SECONDS)
    assert fault.problem.code == "controller.OVERDRIVEN"
    assert fault.title.endswith(f"elbow: its weight of {weight_Nm:.3g} N m is 4 times the torque")


def test_what_somebody_requested_is_no_fault(tmp_path, run):
    state = state_of()
    state["fault"][1000:2000] = State.FAULT_REQUESTED
    state["drive_state"][1000:2000] = State.DRIVE_HOLD
    log = log_of(tmp_path / "log", JOINT_STATE=state, CONTROLLER_STATUS=status_of())
    assert find_faults(log, run.robot, end_s=SECONDS) == []


def stopped_at(state: np.ndarray, status: np.ndarray, row: int) -> None:
    """As a driver ends: it brakes, then the drives are off."""
    state["fault"][row:] = State.FAULT_REQUESTED
    state["drive_state"][row : row + 300] = State.DRIVE_DAMP
    state["drive_state"][row + 300 :] = State.DRIVE_OFF
    status["mode"][row // 5 :] = Status.MODE_FAULT
    status["reason"][row // 5 :] = Status.REASON_DRIVER_FAULT


def test_a_run_that_the_user_stops_ends_well(tmp_path, run):
    state, status, truth = state_of(), status_of(), truth_of()
    stopped_at(state, status, 2500)
    channels = {"JOINT_STATE": state, "CONTROLLER_STATUS": status, "SIM_TRUTH": truth}
    log = log_of(tmp_path / "log", **{name: rows[:2900] for name, rows in channels.items()})
    summary = measure(log, run, "realtime", stopped=True)[0]
    assert summary.find("stopped").value == "by you after 2.5 s"
    assert summary.find("faults").value == "none"
    assert summary.passed
    assert not measure(log, run, "realtime")[0].passed, "if nobody stopped it, it is a fault"


def test_a_fault_before_the_user_stops_is_still_one(tmp_path, run):
    state, status = state_of(), status_of()
    too_fast(state, status)
    log = log_of(tmp_path / "log", JOINT_STATE=state, CONTROLLER_STATUS=status)
    summary = measure(log, run, "realtime", stopped=True)[0]
    assert summary.find("faults").value == "driver.VELOCITY"
    assert not summary.passed


def answer(client: int, accepted: int, **fields):
    made = Answer()
    made.client, made.accepted, made.kind = client, accepted, Answer.KIND_GOAL
    for name, value in fields.items():
        setattr(made, name, value)
    return made


def test_a_refused_request_of_the_scenario_fails_the_run(tmp_path, run):
    cause = {"code": Answer.REFUSED_GOAL_KIND, "reason": "not joint goals"}
    answers = [
        answer(SCENARIO_CLIENT, 1, time_ns=9 * 10**8),
        answer(SCENARIO_CLIENT, 0, time_ns=10**9, **cause),
        answer(77, 0, time_ns=2 * 10**9, **cause),
    ]
    status = status_of()
    status["requests_refused"] = 2
    log = log_of(tmp_path / "log", answers, JOINT_STATE=state_of(), CONTROLLER_STATUS=status)
    summary = measure(log, run, "lab")[0]
    refused = summary.find("requests refused")
    assert (refused.value, refused.passed) == (1, False)
    assert refused.note.startswith("goal at 1 s: request.GOAL_KIND: not joint goals; 1 of other")
    others = log_of(
        tmp_path / "others", answers[2:], JOINT_STATE=state_of(), CONTROLLER_STATUS=status
    )
    refused = measure(others, run, "lab")[0].find("requests refused")
    assert (refused.value, refused.passed) == (1, False), "one is counted and not in the log"
    status["requests_refused"] = 1
    alone = log_of(
        tmp_path / "alone", answers[2:], JOINT_STATE=state_of(), CONTROLLER_STATUS=status
    )
    assert measure(alone, run, "lab")[0].find("requests refused").passed is True


def test_only_what_is_numbered_can_be_lost(tmp_path):
    """Requests and answers begin with a clock; two senders have numbers of their own."""
    two = records("controller_status_t", 8, controller=[1, 2] * 4, seq=[5, 900] * 4)
    two["seq"] += np.arange(8) // 2
    answers = [answer(1, 1, time_ns=time) for time in (10, 5 * 10**9)]
    modes = records("mode_request_t", 2, seq=[10, 5 * 10**9])
    log = log_of(tmp_path / "log", answers, CONTROLLER_STATUS=two, MODE_REQUEST=modes)
    assert log.lost("CONTROLLER_STATUS") == 0
    assert log.lost("REQUEST_ANSWER") == log.lost("MODE_REQUEST") == 0
    gap = log_of(tmp_path / "gap", CONTROLLER_STATUS=np.delete(two, [2, 5]))
    assert gap.lost("CONTROLLER_STATUS") == 2
