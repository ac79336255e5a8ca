"""The runner with the real programs: a good run, Ctrl-C, a process that dies. All private."""

import json
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from processes import started

from limber.log.reader import Log
from limber.paths import ROOT

QUICK = ROOT / "scenarios" / "quick.yaml"
LONG = "format: limber-scenario/1\nrobot: desktop2r\nmode: realtime\nduration_s: 100\n"


def children(pid: int) -> dict[str, int]:
    """Program -> process id."""
    found = {}
    for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split():
        found[Path(f"/proc/{child}/exe").resolve().name] = int(child)
    return found


def wait_until(condition: Callable[[], bool], what: str, timeout_s: float = 20) -> None:
    deadline = time.monotonic() + timeout_s
    while not condition():
        assert time.monotonic() < deadline, f"waited in vain for {what}"
        time.sleep(0.02)


@pytest.fixture
def long_run(tmp_path):
    """A run under way: (process, folder, its children)."""
    (tmp_path / "long.yaml").write_text(LONG)
    folder = tmp_path / "out"
    command = [sys.executable, "-m", "limber", "run", str(tmp_path / "long.yaml"), "--private"]
    with started(
        [*command, "--out", str(folder)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        stdin=subprocess.DEVNULL,
        text=True,
    ) as process:
        log = folder / "limber-driver.log"

        def drives_speak() -> bool:
            assert process.poll() is None, process.stderr.read()
            return log.exists() and "drives: off" in log.read_text()

        wait_until(drives_speak, "the drives")
        yield process, folder, children(process.pid)
        process.kill()


def gone(programs: dict[str, int]) -> bool:
    return not any(Path(f"/proc/{pid}").exists() for pid in programs.values())


def test_lockstep_run_leaves_everything(limber, tmp_path):
    done = limber("run", str(QUICK), "--lockstep", "--private", "--can", "--out", str(tmp_path))
    assert done.returncode in (0, 1), done.stderr
    assert "stiffness" in done.stdout
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["mode"] == "lockstep" and summary["robot"] == "openarm"
    assert summary["pass"] is (done.returncode == 0)
    names = {path.name for path in tmp_path.iterdir()}
    assert {
        "run.lcmlog.zst",
        "scenario.yaml",
        "robot.yaml",
        "robot.urdf",
        "limber-sim.log",
    } <= names
    frames = (tmp_path / "run.can.log").read_text()
    assert frames.count(" openarm 1FFFFFF0#") >= 3000, (
        "a TICK each cycle, and those of the roll call"
    )
    log = Log(tmp_path)
    assert len(log.read("JOINT_STATE")) == len(log.read("JOINT_TORQUE")) == 3000
    assert all(log.lost(channel) == 0 for channel in log.channels)

    again = limber("measure", str(tmp_path))
    assert again.returncode == done.returncode, again.stderr
    assert json.loads((tmp_path / "summary.json").read_text())["results"] == summary["results"]


@pytest.mark.parametrize("how", [["run", "--private", "--lockstep"], ["lab"]])
def test_another_arm_than_the_scenarios(limber, tmp_path, how):
    held = tmp_path / "held.yaml"
    timeline = "timeline:\n  - {at_s: 0.3, mode: hold}\n"
    held.write_text(LONG.replace("100", "1") + timeline, encoding="utf-8")
    out = tmp_path / "run"
    done = limber(how[0], str(held), "--robot", "openarm_right", "--out", str(out), *how[1:])
    assert done.returncode == 0, done.stderr
    assert json.loads((out / "summary.json").read_text())["robot"] == "openarm_right"
    assert {"HAND_STATE", "HAND_TRUTH"} <= set(Log(out).channels), "the arm with a hand"
    again = limber("measure", str(out))
    assert again.returncode == 0, again.stderr
    wrong = limber(how[0], str(held), "--robot", "openarm_rigth", *how[1:])
    assert wrong.returncode == 2 and "no robot 'openarm_rigth'" in wrong.stderr


def test_ctrl_c_ends_in_good_order(long_run):
    process, folder, programs = long_run
    assert set(programs) == {"limber-record", "limber-sim", "limber-controller", "limber-driver"}
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=30)
    assert process.returncode in (0, 1), errors
    assert gone(programs)
    summary = json.loads((folder / "summary.json").read_text())
    assert summary["stopped_early"] is True
    assert len(Log(folder).read("JOINT_STATE")) > 10
    assert "disabled" in (folder / "limber-driver.log").read_text(), "the drives were switched off"


def test_a_process_that_dies_is_named(long_run):
    process, folder, programs = long_run
    subprocess.run(["kill", "-KILL", str(programs["limber-sim"])], check=True)
    _, errors = process.communicate(timeout=30)
    assert process.returncode == 3
    lines = errors.splitlines()
    assert len(lines) == 1
    assert lines[0].startswith("limber: limber-sim ended (killed by SIGKILL)"), lines
    assert str(folder / "limber-sim.log") in lines[0]
    assert gone(programs)


def test_a_recorder_that_dies_stops_no_arm(long_run):
    process, folder, programs = long_run
    subprocess.run(["kill", "-KILL", str(programs["limber-record"])], check=True)
    time.sleep(1.0)
    assert process.poll() is None, "the run goes on"
    assert "limber-driver" in children(process.pid)
    process.send_signal(signal.SIGINT)
    output, errors = process.communicate(timeout=30)
    assert "limber-record ended (killed by SIGKILL)" in output
    assert "the run goes on without it" in output
    assert process.returncode == 3, "but the log is not whole"
    assert "limber-record ended" in errors
    assert "disabled" in (folder / "limber-driver.log").read_text(), "in good order"
    assert gone(programs)


def test_kill_of_limber_itself_leaves_nothing(long_run):
    process, _, programs = long_run
    process.kill()
    process.wait()
    wait_until(lambda: gone(programs), "the children to end")
