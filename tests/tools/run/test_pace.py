"""When a run is in lock step, at whose pace; what the demo does on a machine that is too slow."""

import io
from types import SimpleNamespace

import pytest
from rich.console import Console

from limber.errors import InputError
from limber.run import demo, runner
from limber.run.options import FinishedRun, RunOptions
from limber.run.pace import Pace, choose

VIRTUAL, REAL = {"a": "virtual:x"}, {"a": "socketcan:can0"}
MIXED = VIRTUAL | {"b": "socketcan:can1"}


def scenario(buses: dict, lockstep: bool):
    return SimpleNamespace(robot=SimpleNamespace(buses=buses), lockstep=lockstep)


@pytest.mark.parametrize(
    "buses, lockstep, options, pace",
    [
        (VIRTUAL, False, {}, Pace.PACED),
        (VIRTUAL, True, {}, Pace.LOCKSTEP),
        (VIRTUAL, False, {"lockstep": True}, Pace.LOCKSTEP),
        (VIRTUAL, True, {"lockstep": False}, Pace.REALTIME),
        (VIRTUAL, True, {"one_process": True}, Pace.LOCKSTEP),
        (VIRTUAL, False, {"one_process": True}, Pace.PACED),
        (VIRTUAL, True, {"with_simulator": False}, Pace.REALTIME),
        (REAL, True, {}, Pace.REALTIME),
        (REAL, True, {"with_simulator": False}, Pace.REALTIME),
        (MIXED, True, {"with_simulator": False}, Pace.REALTIME),
        (REAL, True, {"buses": ("a=virtual:y",)}, Pace.LOCKSTEP),
        (VIRTUAL, False, {"buses": ("a=socketcan:can7",)}, Pace.REALTIME),
        (REAL, False, {"lockstep": True}, Pace.LOCKSTEP),  # a simulator on vcan, for tests
    ],
)
def test_the_pace(buses, lockstep, options, pace):
    assert choose(scenario(buses, lockstep), RunOptions(**options)) == pace


@pytest.mark.parametrize(
    "buses, options",
    [
        (REAL, {"lockstep": True, "with_simulator": False}),
        (MIXED, {"lockstep": True, "with_simulator": False}),
        (REAL, {"one_process": True}),
        (VIRTUAL, {"one_process": True, "with_simulator": False}),
        (VIRTUAL, {"one_process": True, "lockstep": False}),
    ],
)
def test_motors_wait_for_nobody(buses, options):
    with pytest.raises(InputError, match=r"--lockstep: motors on|--one-process: simulated arms"):
        choose(scenario(buses, True), RunOptions(**options))


def test_the_demo_goes_over_to_one_process(monkeypatch, tmp_path):
    ran = []

    def run(scenario, folder, options, console):
        ran.append((folder.name, options.one_process, options.leave_when_behind))
        lags = not options.one_process
        words = "simulated time runs at 21 % of real time (load average 6.0 on 2 processors): ..."
        return FinishedRun(folder, "paced", behind=words if lags else "")

    monkeypatch.setattr(runner, "run", run)
    text = io.StringIO()
    options = RunOptions(tmp_path / "demo", leave_when_behind=True)
    finished = demo._run(SimpleNamespace(), options, Console(file=text, width=200))
    assert ran == [("demo", False, True), ("demo-one-process", True, False)]
    assert finished.folder.name == "demo-one-process" and not finished.behind
    assert "simulated time runs at 21 % of real time" in text.getvalue()
    assert "--one-process" in text.getvalue()


def test_a_demo_that_keeps_up_runs_once(monkeypatch, tmp_path):
    ran = []

    def run(scenario, folder, options, console):
        ran.append(folder)
        return FinishedRun(folder, "paced")

    monkeypatch.setattr(runner, "run", run)
    demo._run(SimpleNamespace(), RunOptions(tmp_path / "d"), Console(file=io.StringIO()))
    assert len(ran) == 1
