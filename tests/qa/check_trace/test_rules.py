"""Each rule on frames made by hand: what is within its limit passes, what is beyond it is named."""

import pytest
from wire import ARM, DISABLE, ENABLE, STEP_Nm, TORQUE_LIMIT_Nm, Wire, command, reply

from limber_qa.check_trace.judge import Verdict
from limber_qa.check_trace.stops import Expectation

SPEED_LIMIT = ARM.motors[0].velocity
LOW, HIGH = ARM.motors[0].position
HOLD = command(kp=40, kd=2)
DAMP = command(kd=2)
MS = 1_000_000


@pytest.fixture
def wire() -> Wire:
    """Enabled, and following for ten cycles."""
    made = Wire()
    made.step(ENABLE, reply(1, status=0), ENABLE, reply(2, status=0))
    made.step(times=10)
    return made


def rules(verdict: Verdict) -> set[tuple[str, str]]:
    return {(breach.joint, breach.rule) for breach in verdict.breaches}


def ramp(wire: Wire, start: float, end: float, step: float = STEP_Nm) -> None:
    """The shoulder's torque goes there in steps that are allowed."""
    count = max(1, round(abs(end - start) / step + 0.5))
    for number in range(1, count + 1):
        wire.step(command(start + (end - start) * number / count))


def test_the_limits_are_those_of_robot_yaml():
    shoulder = ARM.motors[0]
    assert shoulder.torque_Nm == TORQUE_LIMIT_Nm
    assert shoulder.torque_step_Nm == pytest.approx(STEP_Nm)
    assert SPEED_LIMIT <= 30.0
    assert LOW < 0.0 < HIGH


def test_a_quiet_arm_breaks_no_rule(wire, tmp_path):
    verdict = wire.judged(tmp_path)
    assert verdict.passed
    assert verdict.commands == 22
    assert verdict.states == 22


@pytest.mark.parametrize("sign", [1, -1])
def test_torque_to_the_limit_and_beyond(wire, tmp_path, sign):
    ramp(wire, 0.0, sign * TORQUE_LIMIT_Nm)
    assert wire.judged(tmp_path).passed
    wire.step(command(sign * (TORQUE_LIMIT_Nm + 0.1)))
    verdict = wire.judged(tmp_path)
    assert rules(verdict) == {("shoulder", "torque")}
    assert verdict.breaches[0].number == pytest.approx(sign * (TORQUE_LIMIT_Nm + 0.1), abs=0.003)
    assert verdict.breaches[0].limit == TORQUE_LIMIT_Nm
    assert verdict.breaches[0].time_ns == (wire.cycle - 1) * MS


def test_the_drives_spring_counts_as_torque(wire, tmp_path):
    wire.step(command(kp=40, kd=2, angle=0.9 * TORQUE_LIMIT_Nm / 40))
    assert wire.judged(tmp_path).passed
    wire.step(command(kp=40, kd=2, angle=1.2 * TORQUE_LIMIT_Nm / 40))
    assert rules(wire.judged(tmp_path)) == {("shoulder", "torque")}


def test_torque_steps_to_the_limit_and_beyond(wire, tmp_path):
    wire.step(command(STEP_Nm))
    assert wire.judged(tmp_path).passed
    wire.step(command(2.2 * STEP_Nm))
    verdict = wire.judged(tmp_path)
    assert rules(verdict) == {("shoulder", "rate")}
    assert verdict.breaches[0].number == pytest.approx(1.2 * STEP_Nm, abs=0.006)


def test_a_first_torque_begins_at_zero(tmp_path):
    wire = Wire()
    wire.step(ENABLE, reply(1, status=0), ENABLE, reply(2, status=0))
    wire.step(command(3 * STEP_Nm))
    assert rules(wire.judged(tmp_path)) == {("shoulder", "rate")}


def test_damping_alone_and_disabling_may_drop_the_torque(wire, tmp_path):
    ramp(wire, 0.0, 5.0)
    wire.step(DAMP, times=3)
    wire.step(DISABLE)
    assert wire.judged(tmp_path).passed


def test_a_hold_may_not_jump(wire, tmp_path):
    wire.step(command(torque=4.5, kp=40, kd=2))
    assert rules(wire.judged(tmp_path)) == {("shoulder", "rate")}


def test_after_a_hold_the_whole_torque_counts(wire, tmp_path):
    """The spring makes 2 N m: to go on from there is no step, to go on from 0 is one."""
    wire.step(command(kp=40, kd=2, angle=0.05))
    wire.step(command(2.0))
    assert wire.judged(tmp_path).passed
    wire.step(command(kp=40, kd=2, angle=0.0, torque=2.0))
    wire.step(command(0.0))
    assert rules(wire.judged(tmp_path)) == {("shoulder", "rate")}


def test_three_replies_above_the_speed_are_followed_by_damping(wire, tmp_path):
    fast = reply(1, speed=1.15 * SPEED_LIMIT)
    wire.step(shoulder_reply=fast, times=3)
    wire.step(DAMP, fast, DAMP, times=5)
    assert wire.judged(tmp_path).passed


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize(("share", "passes"), [(1.0, True), (0.5, False), (0.0, False)])
def test_a_torque_goes_over_to_damping_at_its_rate(wire, tmp_path, way, share, passes):
    fast = reply(1, speed=way * 1.15 * SPEED_LIMIT)
    wire.step(command(way * 6.5), fast, times=3)
    for cycle in range(15):
        wire.step(command(way * (6.5 - share * STEP_Nm * cycle), kd=0.2), fast)
    assert (("shoulder", "speed") not in rules(wire.judged(tmp_path))) == passes


def test_the_command_on_its_way_is_no_breach(wire, tmp_path):
    """The one that leaves while the third reply arrives late, or the first one from outside."""
    fast = reply(1, speed=1.15 * SPEED_LIMIT)
    wire.step(command(0.3), fast, times=4)
    wire.step(DAMP, times=3)
    wire.step(shoulder_reply=reply(1, angle=HIGH + 0.05))
    wire.step(times=2)
    assert wire.judged(tmp_path).passed


def test_to_go_on_above_the_speed_is_a_breach(wire, tmp_path):
    fast = reply(1, speed=1.15 * SPEED_LIMIT)
    wire.step(command(0.3), fast, times=5)
    verdict = wire.judged(tmp_path)
    assert rules(verdict) == {("shoulder", "speed")}
    assert verdict.breaches[0].number == pytest.approx(1.15 * SPEED_LIMIT, abs=0.01)
    assert verdict.breaches[0].limit == pytest.approx(1.1 * SPEED_LIMIT)


@pytest.mark.parametrize("factor", [1.05, -1.05])
def test_up_to_110_percent_nothing_trips(wire, tmp_path, factor):
    wire.step(command(0.3), reply(1, speed=factor * SPEED_LIMIT), times=9)
    assert wire.judged(tmp_path).passed


@pytest.mark.parametrize("end", [LOW - 0.05, HIGH + 0.05])
def test_outside_its_limits_a_joint_does_not_follow(wire, tmp_path, end):
    outside = reply(1, angle=end)
    wire.step(shoulder_reply=outside)
    wire.step(command(kp=40, kd=2, angle=end), outside, HOLD, times=9)
    assert wire.judged(tmp_path).passed
    wire.step(command(0.0), outside, times=3)
    found = rules(wire.judged(tmp_path))
    assert ("shoulder", "position") in found


def test_a_margin_of_0_02_rad_is_free(wire, tmp_path):
    wire.step(shoulder_reply=reply(1, angle=HIGH + 0.018), times=5)
    assert wire.judged(tmp_path).passed


@pytest.mark.parametrize(
    ("data", "words"),
    [
        ("7FFF7FF0000007", "7 bytes"),
        ("", "0 bytes"),
        ("R", "0 bytes"),
        ("FFFFFFFFFFFFFFFE", "sets the zero"),
    ],
)
def test_what_is_no_command_is_named(wire, tmp_path, data, words):
    wire.frame("001", data)
    verdict = wire.judged(tmp_path)
    assert rules(verdict) == {("shoulder", "frame")}
    assert words in verdict.breaches[0].text


def test_a_command_of_another_mode_is_none(wire, tmp_path):
    wire.frame("101", "0000000000000000")
    assert rules(wire.judged(tmp_path)) == {("shoulder", "frame")}


def test_an_fd_frame_on_a_classic_bus_is_none(wire, tmp_path):
    wire.lines.append(f"(0.500000) desktop2r 001##1{command()}")
    assert rules(wire.judged(tmp_path)) == {("shoulder", "frame")}


def test_stop_times_count_to_the_slowest_drive(wire, tmp_path):
    fault_ns = wire.cycle * MS
    wire.step(times=3)
    wire.step(HOLD, elbow=None)
    wire.step(HOLD, elbow=HOLD)
    for limit_ms, passed in ((4, True), (3, False)):
        verdict = wire.judged(tmp_path, Expectation(fault_ns, limit_ms * MS))
        assert verdict.passed is passed
        assert verdict.stop_ms == pytest.approx(4.001)
    assert rules(verdict) == {("elbow", "stop")}


def test_a_stop_that_never_comes(wire, tmp_path):
    fault_ns = wire.cycle * MS
    wire.step(times=20)
    verdict = wire.judged(tmp_path, Expectation(fault_ns, 4 * MS))
    assert rules(verdict) == {("shoulder", "stop"), ("elbow", "stop")}
    assert verdict.stop_ms is None


def test_a_bus_that_falls_silent_is_the_drives_watchdogs_business(wire, tmp_path):
    assert wire.judged(tmp_path, Expectation(wire.cycle * MS, 4 * MS)).passed


def test_the_others_stop_when_a_drive_fails(wire, tmp_path):
    failed = reply(1, status=0xA)
    wire.step(shoulder_reply=failed)
    wire.step("", failed, HOLD, times=3)
    assert wire.judged(tmp_path).passed


def test_to_follow_on_beside_a_failed_drive_is_a_breach(wire, tmp_path):
    wire.step(shoulder_reply=reply(1, status=0xA), times=9)
    assert rules(wire.judged(tmp_path)) == {("shoulder", "stop"), ("elbow", "stop")}


def test_to_follow_on_beside_a_silent_drive_is_a_breach(wire, tmp_path):
    wire.step(shoulder_reply="", times=3)
    wire.step(HOLD, "", HOLD)
    assert wire.judged(tmp_path).passed
    wire.step(shoulder_reply="", times=9)
    silent = wire.judged(tmp_path, Expectation(silent_cycles=20))
    assert silent.passed
    wire.lines.clear()
    wire.step(times=5)
    wire.step(shoulder_reply="", times=9)
    assert ("elbow", "stop") in rules(wire.judged(tmp_path))


def test_nobody_follows_again_without_an_acknowledgement(wire, tmp_path):
    fault_ns = wire.cycle * MS
    wire.step(HOLD, elbow=HOLD, times=5)
    assert wire.judged(tmp_path, Expectation(fault_ns, 4 * MS, latched=True)).passed
    wire.step(elbow=HOLD)
    latched = wire.judged(tmp_path, Expectation(fault_ns, 4 * MS, latched=True))
    assert rules(latched) == {("shoulder", "enable")}
    assert wire.judged(tmp_path, Expectation(fault_ns, 4 * MS)).passed


def test_nobody_is_enabled_again_without_an_acknowledgement(wire, tmp_path):
    fault_ns = wire.cycle * MS
    wire.step(DISABLE, elbow=DISABLE)
    wire.step(ENABLE, elbow=DISABLE)
    latched = wire.judged(tmp_path, Expectation(fault_ns, 4 * MS, latched=True))
    assert rules(latched) == {("shoulder", "enable")}
