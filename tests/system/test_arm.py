"""`from limber import Arm` against the real processes."""

import subprocess
import sys
import threading
import time
from contextlib import closing

import numpy as np
import pytest
from processes import started

from limber import (
    Arm,
    FaultError,
    InputError,
    NoStackError,
    NotReachedError,
    RefusedError,
    StackLostError,
    WaitTimeoutError,
)
from limber.lcmtypes.compliance_gains_t import compliance_gains_t
from limber.lcmtypes.controller_status_t import controller_status_t as Status
from limber.lcmtypes.joint_state_t import joint_state_t as State
from limber.log.reader import Log
from stack import BIN


@pytest.fixture
def standing(stack):
    """Drives that may be enabled, in a planar arm without friction; in real time the slow one."""
    if stack.pace != "--realtime":
        stack.robot = "planar2r"
    stack.start_all()
    stack.until(lambda: stack.mode == Status.MODE_IDLE, 20, "IDLE")
    return stack


@pytest.fixture
def arm(standing):
    with Arm() as found:
        yield found


def test_it_finds_the_stack_and_reads_it(standing, arm):
    assert (arm.name, arm.joint_names, arm.simulated) == ("planar2r", ("shoulder", "elbow"), True)
    assert (arm.mode, arm.law, arm.drives) == ("idle", "cartesian_impedance", "off")
    np.testing.assert_allclose(arm.q, standing.state.q[:2], atol=1e-6)
    assert arm.q.shape == arm.v.shape == arm.tau.shape == (2,)
    np.testing.assert_allclose(arm.pose.p, standing.truth.p_BT, atol=1e-5)
    before_s = arm.time_s
    arm.wait(for_s=0.1)
    assert arm.time_s >= before_s + 0.1
    assert arm.faults == [] and arm.warnings == []
    assert sum(arm.lost.values()) == 0


def test_another_robot_and_no_stack(standing):
    with pytest.raises(NoStackError, match="that of planar2r, not of openarm"):
        Arm("openarm")
    standing.kill("driver")
    standing.kill("controller")
    with pytest.raises(NoStackError, match="limber run"):
        Arm()


def test_moves_and_says_how_far_it_came(arm):
    arm.activate()
    start = arm.goal
    there = arm.move([0, 0.05, 0], duration_s=0.5)
    np.testing.assert_allclose(there.goal.p, np.add(start.p, [0, 0.05, 0]), atol=1e-9)
    np.testing.assert_allclose(there.pose.p, there.goal.p, atol=2e-3)
    back = arm.go_to(position_m=start.p)
    np.testing.assert_allclose(back.goal.p, start.p, atol=1e-9)
    arm.wall(start.p, [0, -1, 0])
    with pytest.raises(NotReachedError, match="rests there") as missed:
        arm.go_to(position_m=start.p + np.array([0, 0.05, 0]), duration_s=0.5)
    assert missed.value.distance_m == pytest.approx(0.05, abs=0.003)
    assert missed.value.angle_rad is None
    arm.go_to(start)
    arm.no_wall()
    with pytest.raises(InputError, match="11 m is no arm's reach"):
        arm.go_to(position_m=[11, 0, 0])
    arm.gains(law="joint_impedance")
    arm.go_to(joints_rad=[0.6, 1.1])
    np.testing.assert_allclose(arm.q, [0.6, 1.1], atol=0.02)


def test_gains_change_what_they_name(arm):
    arm.activate()
    before = arm.stiffness
    arm.gains(law="joint_pd", ramp_s=0.2)
    arm.wait(until=lambda state: state.law == "joint_pd")
    arm.gains(K_q_Nm_per_rad=[80, 40])
    arm.wait(until=lambda state: np.allclose(state.joint_stiffness, [80, 40]), timeout_s=5)
    np.testing.assert_array_equal(arm.stiffness, before)
    arm.gains(law="cartesian_impedance")
    arm.soften([300, 200, 0])
    np.testing.assert_allclose(np.diag(arm.stiffness)[:3], [300, 200, 0])
    np.testing.assert_allclose(arm.joint_stiffness, [80, 40])


STIFFEST = {"law": "joint_pd", "K_q_Nm_per_rad": 10_000, "joint_damping_ratio": 0.1}


def test_unstable_gains_are_refused(arm):
    with pytest.raises(RefusedError) as refused:
        arm.gains(**STIFFEST)
    assert refused.value.code == "request.UNSTABLE"


def test_a_warning_of_the_controller_is_passed_on(stack, tmp_path):
    """Where the scenario wants to show unstable gains."""
    scenario = tmp_path / "unstable.yaml"
    scenario.write_text(
        "format: limber-scenario/1\nrobot: planar2r\nallow_unstable: true\nduration_s: 60\n",
        encoding="utf-8",
    )
    stack.robot = "planar2r"
    stack.start("sim")
    stack.start("controller", "--scenario", str(scenario))
    time.sleep(0.3)
    stack.start("driver")
    stack.until(lambda: stack.mode == Status.MODE_IDLE, 20, "IDLE")
    with Arm() as arm, pytest.warns(UserWarning, match="taken, but: "):
        arm.gains(**STIFFEST)


def test_a_push_yields_as_the_stiffness_says(arm):
    arm.activate()
    arm.soften(400)
    start = arm.wait(at_rest=True)
    arm.push([0, 8, 0], for_s=3.0, ramp_s=0.3)
    arm.wait(for_s=0.5)
    pushed = arm.wait(at_rest=True, timeout_s=2.0)
    assert pushed.pose.p[1] - start.pose.p[1] == pytest.approx(8 / 400, rel=0.02)


def test_contact_is_felt(arm):
    arm.activate()
    with pytest.raises(InputError, match="no contact source"):
        arm.wait(contact_N=5)
    arm.wait(for_s=1.0)  # the stand is away
    arm.gains(contact="joint_torque", K_x_translation_N_per_m=500)
    p = arm.pose.p
    arm.wall(p - [0, 0.03, 0], [0, 1, 0])
    arm.set_goal(offset_m=[0, -0.06, 0], duration_s=1.0)
    felt = arm.wait(contact_N=8)
    assert felt.pose.p[1] == pytest.approx(p[1] - 0.03, abs=3e-3)
    assert felt.wrench[1] > 7.5


def test_a_stream_of_goals_is_followed_smoothly(arm):
    """50 goals a second along a circle: no stop between them, a constant lag."""
    arm.activate()
    centre, radius, turn = arm.goal.p - [0.05, 0, 0], 0.05, np.pi
    start_s = arm.time_s
    kept: list[np.ndarray] = []
    end = arm.on_state(kept.append, channel="CONTROLLER_STATUS")
    for state in arm.states(hz=50):
        t = state.time_s - start_s
        if t > 3.0:
            break
        on_circle = [np.cos(turn * t), np.sin(turn * t), 0]
        arm.track(position_m=centre + radius * np.array(on_circle))
    end()
    status = np.concatenate(kept)
    t = 1e-9 * status["time_ns"] - start_s
    status = status[(t > 1.0) & (t < 2.9)]
    speed = np.linalg.norm(np.diff(status["p_BD"][::10], axis=0), axis=1)
    assert speed.min() > 0.5 * radius * turn * 0.05
    away = np.linalg.norm(status["p_BD"] - centre, axis=1)
    np.testing.assert_allclose(away, radius, atol=3e-3)
    arm.wait(at_rest=True, timeout_s=5)  # by itself


def test_every_state_reaches_a_slow_callback(arm):
    kept: list[np.ndarray] = []

    def slow(states: np.ndarray) -> None:
        kept.append(states)
        time.sleep(0.3)

    end = arm.on_state(slow)
    arm.wait(for_s=1.0)
    end()
    seq = np.concatenate(kept)["seq"]
    assert len(seq) > 900
    np.testing.assert_array_equal(np.diff(seq), 1)


def test_states_come_at_a_rate(arm):
    times = [state.time_s for state, _ in zip(arm.states(hz=100), range(20), strict=False)]
    assert np.all(np.diff(times) > 0)


def test_refusals_carry_code_and_reason(arm):
    with pytest.raises(RefusedError, match="the way there: hold, active") as refused:
        arm.set_goal(offset_m=[0, 0.01, 0])
    assert refused.value.code == "request.MODE"
    with pytest.raises(RefusedError, match="elastic joint"):
        arm.gains(law="tomei")
    with pytest.raises(InputError, match="did you mean 'K_x_translation_N_per_m'"):
        arm.gains(K_z_translation_N_per_m=3)
    arm.gains(damping_ratio=0.8)  # and it goes on


def test_two_scripts_and_the_lease(standing, arm):
    arm.gains(damping_ratio=0.8)
    with Arm(client=5) as other:
        with pytest.raises(RefusedError, match="another client holds the lease") as refused:
            other.gains(damping_ratio=0.9)
        assert refused.value.code == "request.LEASE"
        other.stop()  # needs no lease
        arm.release()
        other.gains(damping_ratio=0.9)
        with pytest.raises(RefusedError, match="another client holds the lease"):
            arm.gains(damping_ratio=0.8)
    arm.gains(damping_ratio=0.8)  # the other one gave it back at its end


def test_the_block_leaves_the_arm_held_and_the_lease_free(standing):
    with pytest.raises(ZeroDivisionError), Arm() as arm:
        arm.activate()
        _ = 1 / 0
    standing.until(lambda: standing.mode == Status.MODE_HOLD, 5, "HOLD")
    with Arm(client=5) as other:
        other.gains(damping_ratio=0.9)


def test_a_script_that_forgets_to_close_leaves_it_held_too(standing):
    code = "from limber import Arm; arm = Arm(); arm.activate(); print(arm.mode)"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=300, cwd="/"
    )
    assert done.stdout.strip() == "active", done.stderr
    standing.until(lambda: standing.mode == Status.MODE_HOLD, 5, "HOLD")


STREAM = """
from limber import Arm
with Arm() as arm:
    arm.activate()
    for state in arm.states(hz=50):
        arm.track(position_m=arm.goal.p, valid_for_s=0.2)
        print(".", flush=True)
"""


def test_a_script_that_is_killed_in_its_stream_leaves_it_held(standing):
    with started([sys.executable, "-c", STREAM], stdout=subprocess.PIPE, text=True) as script:
        for _ in range(20):
            assert script.stdout.readline() == ".\n"
        assert standing.mode == Status.MODE_ACTIVE
        script.kill()
    standing.until(lambda: standing.mode == Status.MODE_HOLD, 20, "HOLD")
    status = standing.user.latest("CONTROLLER_STATUS")
    assert status.reason == Status.REASON_CLIENT_SILENT
    assert standing.state.drive_state == State.DRIVE_ON


def test_a_stop_ends_a_motion(arm):
    arm.activate()
    stopper = threading.Timer(0.3, arm.stop)
    stopper.start()
    with pytest.raises(NotReachedError, match="stopped, mode"):
        arm.move([0, 0.1, 0], duration_s=5.0)
    stopper.join()
    assert arm.wait(mode="hold", timeout_s=5).mode == "hold"


@pytest.mark.realtime
def test_a_fault_ends_what_waits_and_is_acknowledged(standing, arm):
    arm.activate()
    killer = threading.Timer(0.3, lambda: standing.kill("sim"))
    killer.start()
    with pytest.raises(FaultError, match="REPLY_LOST"):
        arm.wait(at_rest=True, until=lambda state: False, timeout_s=20)
    killer.join()
    with pytest.raises(FaultError):
        arm.activate()
    with pytest.raises(FaultError):  # rather than: goals are accepted in ACTIVE only
        arm.set_goal(offset_m=[0, 0.01, 0])
    standing.start("sim")
    standing.until(lambda: acknowledged(arm), 20, "the acknowledgement")
    arm.activate()


def acknowledged(arm: Arm) -> bool:
    try:
        arm.acknowledge()
    except (RefusedError, WaitTimeoutError):
        return False
    return True


@pytest.mark.realtime
def test_a_stack_that_ends_is_told(standing):
    with closing(Arm()) as arm:
        standing.kill("driver")
        with pytest.raises(StackLostError, match="limber-driver has been silent"):
            arm.wait(mode="active", timeout_s=20)
    with pytest.raises(StackLostError, match="closed"):
        _ = arm.q


def test_waiting_has_an_end(arm):
    with pytest.raises(WaitTimeoutError) as late:
        arm.wait(mode="active", timeout_s=0.2)
    assert isinstance(late.value, TimeoutError)


def test_a_recording_holds_the_block(arm, tmp_path):
    with arm.record(tmp_path / "run.lcmlog") as recording:
        arm.wait(for_s=0.6)
    log = Log(recording.path)
    seq = log.read("JOINT_STATE")["seq"]
    assert 1e-9 * np.ptp(log.read("JOINT_STATE")["time_ns"]) > 0.49
    assert np.ptp(seq) + 1 == len(seq) + recording.lost.get("JOINT_STATE", 0)


def test_a_real_arm_is_not_pushed(arm):
    arm._link.simulated = False
    with pytest.raises(InputError, match="simulated arm only"):
        arm.push([0, 1, 0])


def test_the_requests_are_those_of_limber_send(standing, arm):
    """The same gains by the shell's program: the same bytes but for numbers and sender."""
    given = "K_x_translation_N_per_m: [300, 200, 100], damping_ratio: 0.8, contact: joint_torque"
    entry = f"gains: {{law: pd_plus, {given}, period_cycles: {{inertia: 4}}, ramp_s: 0.5}}"
    subprocess.run([BIN / "limber-send", entry, "mode: release"], check=True)
    arm.gains(
        law="pd_plus",
        K_x_translation_N_per_m=[300, 200, 100],
        damping_ratio=0.8,
        contact="joint_torque",
        period_cycles={"inertia": 4},
        ramp_s=0.5,
    )
    standing.until(lambda: standing.user.count("COMPLIANCE_GAINS") == 2, 5, "both")
    theirs, ours = standing.user.raw["COMPLIANCE_GAINS"]
    theirs, ours = compliance_gains_t.decode(theirs), compliance_gains_t.decode(ours)
    assert sorted(theirs.named) == sorted(ours.named)
    assert (theirs.law, theirs.ramp_s, theirs.scope) == (ours.law, ours.ramp_s, ours.scope)
    assert (theirs.damping_ratio, theirs.contact) == (ours.damping_ratio, ours.contact)
    assert theirs.period_cycles[1] == ours.period_cycles[1]
    np.testing.assert_array_equal(np.diag(theirs.K_x)[:3], np.diag(ours.K_x)[:3])
