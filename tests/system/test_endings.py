"""How a run ends for its user: exit code, rows of the result, the list of events."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from processes import started

from stack import ROOT

pytestmark = pytest.mark.lockstep

LIMBER = [sys.executable, "-m", "limber"]
START = "  - {at_s: 0.3, mode: hold}\n  - {at_s: 0.8, mode: active}\n"


def written(folder: Path, timeline: str, seconds: float = 2, robot: str = "planar2r") -> str:
    path = folder / "scenario.yaml"
    head = f"format: limber-scenario/1\nrobot: {robot}\nmode: lockstep\nfriction: false\n"
    path.write_text(f"{head}duration_s: {seconds}\ntimeline:\n{START}{timeline}", encoding="utf-8")
    return str(path)


def limber(*words: str) -> subprocess.CompletedProcess:
    return subprocess.run(
        [*LIMBER, *words],
        cwd=ROOT / "tools",
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


def rows_of(folder: Path) -> dict[str, dict]:
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    return {row["name"]: row for row in summary["results"]}


@pytest.mark.parametrize("how", ["run", "lab"])
def test_a_refused_goal_is_told_and_fails_the_run(how, tmp_path):
    """Joint angles are no goal for the default law."""
    path = written(tmp_path, "  - {at_s: 1.0, goal: {joints_rad: [0.4, 1.0], duration_s: 0.5}}\n")
    done = limber(how, path, "--out", str(tmp_path / "out"))
    assert done.returncode == 1, done.stdout + done.stderr
    refused = rows_of(tmp_path / "out")["requests refused"]
    assert refused["value"] == 1 and refused["pass"] is False
    assert refused["note"].startswith("goal at 1 s: request.GOAL_KIND: the law follows pose goals")
    foretold = "goal at 1 s will be refused: request.GOAL_KIND"
    happened = "goal at 1.000 s refused: request.GOAL_KIND"
    assert done.stdout.index(foretold) < done.stdout.index(happened)
    name = "limber-lab.log" if how == "lab" else "limber-controller.log"
    assert happened in (tmp_path / "out" / name).read_text(encoding="utf-8")


@contextmanager
def running_until_active(folder: Path, *words: str) -> Iterator[subprocess.Popen]:
    """`limber run WORDS` into the folder, from the moment that the arm is active."""
    with started(
        [*LIMBER, "run", *words, "--out", str(folder)],
        cwd=ROOT / "tools",
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        text=True,
    ) as running:
        log = folder / "limber-controller.log"
        end = time.monotonic() + 60
        while not log.exists() or "mode ACTIVE" not in log.read_text(encoding="utf-8"):
            assert time.monotonic() < end and running.poll() is None
            time.sleep(0.02)
        yield running


def test_a_session_that_its_user_stops_ends_well(tmp_path):
    """After requests from another terminal, whose numbers begin anywhere."""
    path = written(tmp_path, "  - {at_s: 0.9, mode: release}\n", seconds=3600)
    folder = tmp_path / "out"
    with running_until_active(folder, path) as running:
        for _ in range(2):
            sent = limber("send", "--robot", "planar2r", "goal: {offset_m: [0, 0.01, 0]}")
            assert sent.returncode == 0, sent.stderr
        running.send_signal(signal.SIGINT)
        shown, _ = running.communicate(timeout=300)
    assert running.returncode == 0, shown
    rows = rows_of(folder)
    assert rows["stopped"]["value"].startswith("by you after ")
    assert rows["faults"]["value"] == "none"
    assert rows["messages lost"]["value"] == 0, rows["messages lost"]
    listed = limber("log", "events", str(folder)).stdout
    assert listed.count("goal offset: taken") == 2


def test_a_run_without_a_clock_waits_for_its_recorder(tmp_path):
    """The recorder, stopped for half a second: some five thousand cycles' worth."""
    path = written(tmp_path, "", seconds=60)
    folder = tmp_path / "out"
    with running_until_active(folder, path, "--lockstep", "--can") as running:
        children = Path(f"/proc/{running.pid}/task/{running.pid}/children").read_text().split()
        recorders = [
            int(pid)
            for pid in children
            if Path(f"/proc/{pid}/comm").read_text().strip() in ("limber-record", "limber-can")
        ]
        assert len(recorders) == 2
        for pid in recorders:
            os.kill(pid, signal.SIGSTOP)
            time.sleep(0.5)
            assert running.poll() is None
            os.kill(pid, signal.SIGCONT)
        shown, _ = running.communicate(timeout=300)
    assert running.returncode == 0, shown
    assert rows_of(folder)["messages lost"]["value"] == 0
    frames = subprocess.run(
        ["grep", "-c", "8001##", str(folder / "run.can.log")],
        capture_output=True,
        text=True,
        check=False,
    )
    assert int(frames.stdout) >= 60_000 - 5, "a command a cycle to the first motor"


def test_the_events_of_a_run_with_a_fault(tmp_path):
    """A hand gives the arm, which feels weightless, more speed than hands should."""
    timeline = (
        "  - {at_s: 1.0, gains: {law: gravity_compensation}}\n"
        "  - {at_s: 1.5, push: {torque_Nm: [0, 0, 10], ramp_s: 0.05, for_s: 0.6}}\n"
    )
    scenario = written(tmp_path, timeline, robot="desktop2r")
    done = limber("lab", scenario, "--out", str(tmp_path / "out"))
    assert done.returncode == 1, done.stdout + done.stderr
    assert "J, limit 2 J" in done.stdout and "To do: " in done.stdout
    listed = limber("log", "events", str(tmp_path / "out"))
    assert listed.returncode == 0, listed.stderr
    told = [
        "scenario    mode hold: taken",
        "controller  mode ACTIVE",
        "scenario    gains: taken",
        "controller  law gravity_compensation",
        "world       push for ",
        "controller  mode FAULT: controller.ENERGY: ",
    ]
    places = [listed.stdout.find(line) for line in told]
    assert -1 not in places and places == sorted(places), listed.stdout
    assert "driver      drives FALLBACK: driver.REQUESTED" in listed.stdout
