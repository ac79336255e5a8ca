"""The arm plane between two processes only, and the bus in memory: the same bytes as over
multicast, and recoveries.
"""

import os
from pathlib import Path

import pytest

from limber.lcmtypes.controller_status_t import controller_status_t as Status
from limber.lcmtypes.joint_state_t import joint_state_t as State
from same_bytes import expect_equal, of_the_lab, of_three_processes
from stack import ROOT

KINDS = ("unix", "shm", "shm, bus as well", "shm, polled", "shm, bus as well, polled")
BUS_PORT = "43219"


@pytest.fixture(params=KINDS)
def arm_plane(request, tmp_path, monkeypatch):
    """The folder of its sockets, or None."""
    if request.param == "unix":
        folder = tmp_path / "arm"
        folder.mkdir(mode=0o700)
        monkeypatch.setenv("LIMBER_ARM_URL", f"unix:{folder}/arm")
        yield folder
        return
    name = f"system-test-{os.getpid()}"
    poll = "?poll" if "polled" in request.param else ""
    monkeypatch.setenv("LIMBER_ARM_URL", f"shm:{name}{poll}")
    if "bus" in request.param:
        monkeypatch.setenv("LIMBER_VIRTUAL_BUS", f"shm{poll}")
        monkeypatch.setenv("LIMBER_VIRTUAL_BUS_PORT", BUS_PORT)
    yield None
    for pattern in (f"limber-arm-{name}", f"limber-bus-*-{BUS_PORT}*"):
        for left in Path("/dev/shm").glob(pattern):
            left.unlink()


def test_the_bytes_are_those_of_the_lab(arm_plane, tmp_path):
    scenario = ROOT / "scenarios" / "quick.yaml"
    run = of_three_processes(scenario, tmp_path / "run")
    expect_equal(run, of_the_lab(scenario, tmp_path), os.environ["LIMBER_ARM_URL"])
    if arm_plane is not None:
        assert list(arm_plane.iterdir()) == []


@pytest.mark.realtime
@pytest.mark.parametrize("arm_plane", KINDS[:3], indirect=True)
def test_a_killed_controller_is_replaced(arm_plane, stack):
    stack.start_all()
    stack.bring_to(Status.MODE_ACTIVE)
    stack.kill("controller")
    stack.until(lambda: stack.state.drive_state == State.DRIVE_HOLD, 10, "FALLBACK")
    stack.start("controller")
    stack.until(lambda: stack.mode in (Status.MODE_INIT, Status.MODE_IDLE), 10, "the new one")
    stack.acknowledge()
    stack.bring_to(Status.MODE_ACTIVE)


@pytest.mark.realtime
@pytest.mark.parametrize("arm_plane", KINDS[:3], indirect=True)
def test_a_killed_driver_is_replaced(arm_plane, stack):
    """What it has left in the memory is not taken for a state of the new one."""
    stack.start_all()
    stack.bring_to(Status.MODE_ACTIVE)
    session = stack.state.session
    stack.kill("driver")
    stack.until(lambda: stack.mode == Status.MODE_FAULT, 10, "the controller to miss it")
    stack.start("driver")
    stack.until(lambda: stack.state.session != session, 20, "the new one")
    stack.acknowledge()
    stack.bring_to(Status.MODE_ACTIVE)


@pytest.mark.parametrize("arm_plane", KINDS[:2], indirect=True)
def test_a_second_controller_is_refused(arm_plane, stack):
    stack.start_all()
    stack.bring_to(Status.MODE_HOLD)
    second = stack.start("controller", tag="second")
    assert second.wait(10) == 2
    text = stack.log("second")
    del stack.processes["second"]
    assert f"process {stack.processes['controller'].pid}" in text
    assert stack.mode == Status.MODE_HOLD


@pytest.mark.realtime
@pytest.mark.parametrize("arm_plane", KINDS[2:3], indirect=True)
def test_a_killed_simulator_is_replaced(arm_plane, stack):
    """Its place on the bus is free at once, and what it has left there is not taken for replies."""
    stack.start_all()
    stack.bring_to(Status.MODE_ACTIVE)
    stack.kill("sim")
    stack.until(lambda: stack.state.fault != State.FAULT_NONE, 10, "the driver to miss its drives")
    stack.start("sim")
    stack.acknowledge()
    stack.bring_to(Status.MODE_ACTIVE)
