"""The arm plane over Unix sockets: the same bytes as over multicast, and the same recoveries."""

import pytest

from limber.lcmtypes.controller_status_t import controller_status_t as Status
from limber.lcmtypes.joint_state_t import joint_state_t as State
from same_bytes import expect_equal, of_the_lab, of_three_processes
from stack import ROOT


@pytest.fixture
def unix_arm_plane(tmp_path, monkeypatch):
    folder = tmp_path / "arm"
    folder.mkdir(mode=0o700)
    monkeypatch.setenv("LIMBER_ARM_URL", f"unix:{folder}/arm")
    return folder


def test_the_bytes_are_those_of_the_lab(unix_arm_plane, tmp_path):
    scenario = ROOT / "scenarios" / "quick.yaml"
    run = of_three_processes(scenario, tmp_path / "run")
    expect_equal(run, of_the_lab(scenario, tmp_path), "unix sockets")
    assert list(unix_arm_plane.iterdir()) == []


@pytest.mark.flaky(reruns=2)
def test_a_killed_controller_is_replaced(unix_arm_plane, stack):
    stack.start_all()
    stack.bring_to(Status.MODE_ACTIVE)
    stack.kill("controller")
    stack.until(lambda: stack.state.drive_state == State.DRIVE_HOLD, 10, "FALLBACK")
    stack.start("controller")
    stack.until(lambda: stack.mode in (Status.MODE_INIT, Status.MODE_IDLE), 10, "the new one")
    stack.acknowledge()
    stack.bring_to(Status.MODE_ACTIVE)


def test_a_second_controller_is_refused(unix_arm_plane, stack):
    stack.start_all()
    stack.bring_to(Status.MODE_HOLD)
    second = stack.start("controller", tag="second")
    assert second.wait(10) == 2
    text = stack.log("second")
    del stack.processes["second"]
    assert f"process {stack.processes['controller'].pid}" in text
    assert stack.mode == Status.MODE_HOLD
