"""A process is killed: what it did last is kept, cycle by cycle, and told in order."""

import subprocess
import time

import numpy as np
import pytest

from limber.lcmtypes.controller_status_t import controller_status_t as Status
from limber.log.black_box import incidents, read
from limber.log.reader import Log
from stack import ROOT

# Realtime on a machine that others use: a pause longer than the driver bridges is not our fault.
pytestmark = pytest.mark.flaky(reruns=2)
LIMBER = str(ROOT / ".venv" / "bin" / "limber")
RECORDED_s = 3.0


def test_the_cycles_before_a_kill_are_kept(stack, tmp_path):
    stack.start_all()
    stack.bring_to(Status.MODE_ACTIVE)
    time.sleep(RECORDED_s)
    stack.kill("driver")
    time.sleep(0.2)
    last = stack.state.seq
    stack.until(lambda: stack.mode == Status.MODE_FAULT, 10, "the controller's fault")
    stack.until(lambda: len(incidents()) >= 1, 10, "the controller's box")
    stack.start("driver")
    stack.until(
        lambda: any(box.program == "driver" for box in incidents()), 10, "the killed driver's box"
    )
    time.sleep(2.5)  # what comes after is kept, too
    boxes = {box.program: box for box in incidents()}
    assert boxes["driver"].code == "killed"
    assert boxes["controller"].code == "controller.STATE_LOST"

    out = tmp_path / "told"
    done = subprocess.run(
        [LIMBER, "incident", "show", "--out", str(out)], capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 0, done.stderr
    assert "controller.STATE_LOST" in done.stdout
    kept = [record for record in read(boxes["driver"].path) if record.channel == "JOINT_STATE"]
    states = Log(out).read("JOINT_STATE")
    sessions, counts = np.unique(states["session"], return_counts=True)
    numbers = states["seq"][states["session"] == sessions[np.argmax(counts)]]
    assert numbers[-1] in (last, last + 1)
    assert len(kept) > RECORDED_s * 900
    assert np.all(np.diff(numbers[-len(kept) :]) == 1), "no cycle is missing"
    torques = Log(out).read("JOINT_TORQUE")
    assert len(torques) > RECORDED_s * 800
