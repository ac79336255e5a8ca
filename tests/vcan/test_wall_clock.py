"""The wall clock steps while the arm moves: nothing may happen, as no decision reads it.

Only in the guest, whose clock is its own.
"""

import subprocess
import time
from itertools import pairwise
from pathlib import Path

import pytest

from limber.lcmtypes.controller_status_t import controller_status_t as Status
from limber.lcmtypes.joint_state_t import joint_state_t as State
from test_disturbed_bus import start

pytestmark = pytest.mark.skipif(
    "User Mode Linux" not in Path("/proc/cpuinfo").read_text(encoding="ascii"),
    reason="would step the clock of this machine",
)
HOUR_s = 3600


@pytest.fixture
def arm(stack):
    return start(stack, "vxcan0", "vxcan1", "--realtime")


@pytest.mark.parametrize("step_s", [HOUR_s, -HOUR_s])
def test_a_step_of_the_wall_clock_is_not_noticed(arm, step_s):
    before = time.time()
    states = arm.user.count("JOINT_STATE")
    subprocess.run(["date", "-s", f"@{int(before) + step_s}"], check=True, capture_output=True)
    assert abs(time.time() - before - step_s) < HOUR_s / 2, "the clock has stepped"
    time.sleep(2.0)
    assert arm.state.drive_state == State.DRIVE_ON, arm.describe()
    assert arm.mode == Status.MODE_ACTIVE
    times_ns = [state.time_ns for state in arm.user.since("JOINT_STATE", states)]
    assert len(times_ns) > 10
    assert all(earlier < later for earlier, later in pairwise(times_ns))
