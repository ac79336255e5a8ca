"""The hand of a running stack: from Python, the shell and the watch, to the simulated fingers."""

import subprocess
import sys

import pytest

from limber import Arm, InputError, RefusedError
from limber.lcmtypes.controller_status_t import controller_status_t as Status
from limber.lcmtypes.hand_truth_t import hand_truth_t
from stack import ROOT, TYPES

TYPES["HAND_TRUTH"] = hand_truth_t


@pytest.fixture
def handy(stack, tmp_path):
    """OpenArm with its hand, around the first object of the scenario, without its timeline."""
    text = (ROOT / "scenarios" / "grasp.yaml").read_text(encoding="utf-8")
    head, _, _ = text.partition("timeline:")
    quiet = tmp_path / "grasp.yaml"
    quiet.write_text(head + "timeline: [{at_s: 30, mode: release}]\n", encoding="utf-8")
    stack.robot = "openarm_right"
    stack.start_all("--scenario", str(quiet))
    stack.until(lambda: stack.mode == Status.MODE_IDLE, 20, "IDLE")
    return stack


def truth(stack) -> hand_truth_t:
    return stack.user.latest("HAND_TRUTH")


def limber(*arguments: str) -> subprocess.CompletedProcess:
    command = [sys.executable, "-m", "limber", *arguments]
    return subprocess.run(
        command, cwd=ROOT / "tools", timeout=300, capture_output=True, text=True, check=False
    )


def test_grasps_something_and_nothing(handy):
    with Arm("openarm_right") as arm:
        with pytest.raises(RefusedError, match=r"request\.MODE"):
            arm.hand.grasp(30)
        arm.activate()
        assert arm.hand.grasp(40) is True
        arm.wait(for_s=0.3)
        held = arm.hand.state
        assert held.grasped and not held.moving and not held.warm
        assert held.width_m == pytest.approx(0.05, abs=1e-3)
        assert held.force_N == pytest.approx(30, abs=1)  # robot.yaml's hold force
        assert truth(handy).force_N == pytest.approx(30, abs=1.5)
        assert truth(handy).held == 0
        arm.move([0, 0, 0.05])
        assert truth(handy).p_BO[0][2] == pytest.approx(0.557 + 0.04, abs=0.015)
        arm.move([0, 0, -0.05])
        opened = arm.hand.open()
        assert opened.opening == pytest.approx(1, abs=0.01)
        assert truth(handy).held == -1
        arm.move([0, 0, 0.1])
        assert arm.hand.grasp(20) is False
        assert arm.hand.state.width_m == pytest.approx(0, abs=1e-3)
        assert arm.hand(width_m=0.04, force_N=10, speed_m_per_s=0.1).accepted
        arm.wait(until=lambda _: not arm.hand.state.moving, for_s=0.5)
        assert arm.hand.state.width_m == pytest.approx(0.04, abs=1e-3)
        with pytest.raises(RefusedError, match=r"request\.HAND_LIMIT"):
            arm.hand(width_m=0.2)
        assert arm.faults == [] and arm.warnings == []


def test_from_the_shell_and_in_the_watch(handy):
    for entry in ("mode: hold", "mode: active"):
        done = limber("send", entry)
        assert done.returncode == 0, done.stderr
        wanted = Status.MODE_HOLD if "hold" in entry else Status.MODE_ACTIVE
        handy.until(lambda wanted=wanted: handy.mode == wanted, 20, entry)
    done = limber("send", "hand: {width_m: -0.01, force_N: 40}")
    assert done.returncode == 0, done.stderr
    handy.until(lambda: truth(handy).held == 0, 20, "the object to be held")
    handy.pass_time(1.0)
    shown = limber("watch", "--once")
    assert "grasped" in shown.stdout and "HAND_STATE" in shown.stdout, shown.stdout
    wrong = limber("send", "hand: {width_m: 0.2}")
    assert wrong.returncode == 2 and "0.088" in wrong.stderr, wrong.stderr
    meant = limber("send", "gripper: 0.05")
    assert meant.returncode == 2 and "hand: {width_m: 0.05}" in meant.stderr, meant.stderr


def test_an_arm_without_a_hand_has_none(stack):
    stack.robot = "planar2r"
    stack.start_all()
    stack.until(lambda: stack.mode == Status.MODE_IDLE, 20, "IDLE")
    with Arm() as arm, pytest.raises(InputError, match="planar2r has no hand"):
        arm.hand.open()
