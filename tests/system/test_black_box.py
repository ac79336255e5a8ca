"""A process is killed: what it did last is kept, cycle by cycle, and told in order."""

import subprocess
import time

import numpy as np
import pytest
import yaml

from limber.black_box.boxes import kept_boxes, read
from limber.lcmtypes.controller_status_t import controller_status_t as Status
from limber.log.reader import Log
from stack import ROOT, SLOW_HZ

LIMBER = str(ROOT / ".venv" / "bin" / "limber")
RECORDED_s = 3.0


@pytest.mark.realtime
def test_the_cycles_before_a_kill_are_kept(stack, tmp_path):
    stack.start_all()
    stack.bring_to(Status.MODE_ACTIVE)
    stack.pass_time(RECORDED_s)
    stack.kill("driver")
    time.sleep(0.2)
    last = stack.state.seq
    stack.until(lambda: stack.mode == Status.MODE_FAULT, 10, "the controller's fault")
    stack.until(lambda: len(kept_boxes()) >= 1, 10, "the controller's box")
    stack.start("driver")
    stack.until(
        lambda: any(box.program == "driver" for box in kept_boxes()), 10, "the killed driver's box"
    )
    time.sleep(2.5)  # what comes after is kept, too
    boxes = {box.program: box for box in kept_boxes()}
    assert boxes["driver"].code == "killed"
    assert boxes["controller"].code == "controller.STATE_LOST"

    out = tmp_path / "told"
    done = subprocess.run(
        [LIMBER, "log", "black-box", "show", "--out", str(out)],
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    assert "controller.STATE_LOST" in done.stdout
    kept = [record for record in read(boxes["driver"].path) if record.channel == "JOINT_STATE"]
    states = Log(out).read("JOINT_STATE")
    sessions, counts = np.unique(states["session"], return_counts=True)
    numbers = states["seq"][states["session"] == sessions[np.argmax(counts)]]
    assert numbers[-1] in (last, last + 1)
    assert len(kept) > RECORDED_s * 0.9 * SLOW_HZ
    assert np.all(np.diff(numbers[-len(kept) :]) == 1), "no cycle is missing"
    torques = Log(out).read("JOINT_TORQUE")
    assert len(torques) > RECORDED_s * 0.8 * SLOW_HZ


FROZEN = """format: limber-scenario/1
robot: openarm
mode: realtime
duration_s: {end_s}
timeline:
  - {{at_s: 0.3, mode: hold}}
  - {{at_s: 0.8, mode: active}}
  - {{at_s: 1.0, push: {{id: 1, force_N: [0, 8, 0], ramp_s: 0.3, for_s: 4}}}}
  - {{at_s: 1.2, goal: {{offset_m: [0.06, 0, 0], duration_s: 2}}}}
  - {{at_s: {fault_s}, fault: {{joint: joint4, kind: frozen_encoder}}}}
"""


def play(tmp_path, end_s: float, fault_s: float | None) -> subprocess.CompletedProcess:
    scenario = tmp_path / "frozen.yaml"
    text = FROZEN.format(end_s=end_s, fault_s=fault_s)
    scenario.write_text(text if fault_s else text[: text.index("  - {at_s: None")])
    command = [LIMBER, "run", str(scenario), "--out", str(tmp_path / "run")]
    return subprocess.run(command, capture_output=True, text=True, timeout=300)


def test_a_fault_of_the_controller_is_kept_by_all_three_and_drawn(tmp_path):
    """The driver and the simulator saw nothing wrong themselves."""
    told = play(tmp_path, 6.0, 1.5).stdout
    assert "kept: limber log black-box show" in " ".join(told.split())
    assert {box.program for box in kept_boxes()} == {"driver", "controller", "sim"}
    out = tmp_path / "told"
    done = subprocess.run(
        [LIMBER, "log", "black-box", "show", "--out", str(out)],
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    assert "ENCODER_STOPPED" in done.stdout
    assert (out / "reproduce.yaml").is_file(), told + done.stdout
    assert (out / "overview.png").stat().st_size > 20_000
    scenario = yaml.safe_load((out / "reproduce.yaml").read_text())
    (fault,) = [entry["fault"] for entry in scenario["timeline"] if "fault" in entry]
    assert fault == {"joint": "joint4", "kind": "frozen_encoder"}
    (push,) = [entry["push"] for entry in scenario["timeline"] if "push" in entry]
    assert push["force_N"] == pytest.approx([0, 8, 0], abs=0.1)


def test_an_end_that_was_wanted_keeps_no_black_box(tmp_path):
    done = play(tmp_path, 1.3, None)
    assert done.returncode == 0, done.stdout + done.stderr
    assert kept_boxes() == []
