"""An arm behind an adapter on a serial line: driver, pseudo-terminal, adapter, and a virtual bus
with emulated drives.
"""

import shutil

import pytest
import yaml
from serial_adapter import KINDS, SerialAdapter

from limber.lcmtypes.controller_status_t import controller_status_t as Status
from limber.lcmtypes.joint_state_t import joint_state_t as State
from stack import ROOT

SLOW = {"rate_hz": 50, "watchdog": {"timeout_s": 1.0, "reaction": "damp"}}
SOFT = {"K_q_Nm_per_rad": [4, 2], "K_x_translation_N_per_m": 30}


@pytest.fixture(params=KINDS)
def adapter(request, stack, tmp_path):
    """desktop2r, slow enough for a busy machine and a serial line."""
    folder = shutil.copytree(ROOT / "robots/desktop2r", tmp_path / "desktop2r")
    robot = yaml.safe_load((folder / "robot.yaml").read_text(encoding="utf-8"))
    robot |= SLOW
    robot["gains"] |= SOFT
    (folder / "robot.yaml").write_text(yaml.safe_dump(robot), encoding="utf-8")
    stack.robot, stack.pace = str(folder), "--realtime"
    stack.start("sim")
    stack.until(lambda: stack.truth is not None, 20, "the simulator")
    with SerialAdapter(request.param, "desktop2r", tmp_path / "adapter") as found:
        yield found
        stack.close()


@pytest.mark.realtime
def test_an_arm_is_held_and_survives_its_adapter(adapter, stack):
    stack.start("controller")
    stack.start("driver", "--bus", f"arm={adapter.address}")
    stack.bring_to(Status.MODE_HOLD)
    held = stack.positions
    stack.pass_time(1.0)
    assert abs(stack.positions - held).max() < 0.05
    assert stack.state.drive_state == State.DRIVE_ON, stack.describe()
    adapter.unplug()
    stack.until(lambda: stack.state.fault == State.FAULT_BUS, 20, "the lost line")
    adapter.plug_in()
    stack.acknowledge()
    stack.bring_to(Status.MODE_HOLD)


def test_motors_are_found_behind_it(adapter, limber):
    done = limber("motors", "scan", adapter.address)
    assert done.returncode == 0, done.stderr
    assert [line.split()[0] for line in done.stdout.splitlines()] == [
        "damiao_mit:1",
        "damiao_mit:2",
    ]
