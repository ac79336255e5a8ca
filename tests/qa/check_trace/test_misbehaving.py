"""The trace checker and the gate: a controller breaks each limit, with the gate and without.

Both programs are the lab; the one without the gate is linked with another definition of its
judgement, and its driver is told of an arm without limits.
"""

import shutil
import subprocess

import pytest

from limber.paths import programs_folder, robot_folder
from limber_qa.check_trace.judge import Verdict, judge_file
from limber_qa.check_trace.stops import Expectation

FAULT_ns = 1_300_000_000
LIMITS = {
    "torque": "desktop2r",
    "rate": "desktop2r",
    "speed": "desktop2r",
    "position": "desktop2r",
    "finite": "planar2r",
}


def slower(folder):
    """The arm, with speed limits that it can exceed before it reaches its ends."""
    shutil.copytree(robot_folder("desktop2r"), folder)
    file = folder / "robot.yaml"
    text = file.read_text(encoding="utf-8")
    limit = "    bus: arm\n    velocity_limit_rad_per_s: 6\n"
    file.write_text(text.replace("    bus: arm\n", limit), encoding="utf-8")
    return str(folder)


def judged(kind: str, limit: str, tmp_path, expected: Expectation | None = None) -> Verdict:
    trace = tmp_path / "trace.log"
    program = programs_folder().parent / "test_programs" / f"test_{kind}_lab"
    robot = slower(tmp_path / "slower") if limit == "speed" else LIMITS[limit]
    subprocess.run([program, robot, limit, trace], check=True, capture_output=True)
    return judge_file(trace, robot, expected)


@pytest.mark.parametrize("limit", LIMITS)
def test_without_the_gate_the_limit_is_broken_and_named(limit, tmp_path):
    verdict = judged("unguarded", limit, tmp_path)
    found = {(breach.joint, breach.rule) for breach in verdict.breaches}
    assert ("shoulder", limit) in found
    first = next(breach for breach in verdict.breaches if breach.rule == limit)
    assert first.time_ns >= FAULT_ns


@pytest.mark.parametrize("limit", LIMITS)
def test_with_the_gate_no_limit_is_broken_and_the_arm_stops(limit, tmp_path):
    verdict = judged("guarded", limit, tmp_path, Expectation(FAULT_ns, latched=True))
    assert verdict.breaches == []
    assert verdict.stop_ms is not None
