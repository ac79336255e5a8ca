"""`limber test`: what runs in order, what beside others, and that nothing is lost."""

import os
import subprocess
import sys
import time

import pytest
from rich.console import Console

from limber_qa import selftest
from limber_qa.selftest import AT_ONCE, Lane, Part


def part(code: str, lane: Lane = Lane.REAL_TIME) -> Part:
    return Part(lambda: [sys.executable, "-c", code], lane)


@pytest.fixture
def parts(monkeypatch):
    def replace(**chosen: Part) -> None:
        monkeypatch.setattr(selftest, "PARTS", chosen)

    return replace


def test_lanes_run_beside_one_another_and_each_in_order(parts, tmp_path):
    """`first` waits for what only another lane writes."""
    wait = "import pathlib, time; p = pathlib.Path({!r})\nwhile not p.exists(): time.sleep(0.01)"
    one, two = str(tmp_path / "one"), str(tmp_path / "two")
    parts(
        first=part(wait.format(one)),
        second=part(f"open({two!r}, 'x')"),
        other=part(f"open({one!r}, 'x')", Lane.BUILDS),
        then=part(wait.format(two), Lane.BUILDS),
    )
    assert selftest.run(["first", "second", "other", "then"], Console(width=100))


def test_the_last_lane_waits_for_all_others(parts, tmp_path):
    done = tmp_path / "done"
    parts(
        last=part(f"import pathlib; assert pathlib.Path({str(done)!r}).exists()", Lane.LAST),
        slow=part(f"import time; time.sleep(0.3); open({str(done)!r}, 'x')", Lane.SIMULATED),
    )
    assert selftest.run(["last", "slow"], Console(width=100))


def test_only_real_time_has_the_usual_priority(parts, tmp_path):
    note = "import os; open({!r}, 'w').write(str(os.sched_getscheduler(0)))"
    files = {lane: tmp_path / lane.name for lane in Lane}
    parts(**{lane.name: part(note.format(str(files[lane])), lane) for lane in Lane})
    usual = os.sched_getscheduler(0)
    assert selftest.run([lane.name for lane in Lane], Console(width=100))
    policies = {lane: int(file.read_text()) for lane, file in files.items()}
    assert policies == {lane: os.SCHED_IDLE for lane in Lane} | dict.fromkeys(AT_ONCE, usual)


def test_one_failure_fails_all_and_stops_nothing(parts, tmp_path, capfd):
    ran = tmp_path / "ran"
    note = f"open({str(ran)!r}, 'a').write('x'); print('seen')"
    failing = "import sys; print('bad news'); sys.exit(1)"
    parts(
        a=part(note),
        b=part(failing, Lane.BUILDS),
        c=part(note, Lane.BUILDS),
        d=part(note, Lane.SIMULATED),
    )
    assert not selftest.run(list("abcd"), Console(width=100))
    assert ran.read_text() == "xxx"
    output = capfd.readouterr().out
    assert output.count("seen") == 3
    assert "bad news" in output
    summary = output[output.index("summary") :]
    assert summary.count("passed") == 3
    assert summary.count("FAILED") == 1
    assert "bad news" in summary  # where a log that keeps its end alone still shows it


def test_what_failed_is_named_however_long_its_output_is(parts, capfd):
    lines = "print('FAILED tests/a.py::one - ' + 'x' * 999, *range(500), sep=chr(10))"
    parts(a=part(f"{lines}; import sys; sys.exit(1)", Lane.BUILDS))
    assert not selftest.run(["a"], Console(width=100))
    output = capfd.readouterr().out
    summary = output[output.index("summary") :].splitlines()
    assert any(line.startswith("FAILED tests/a.py::one") for line in summary)
    assert max(map(len, summary)) <= 200 and "499" in summary and "400" not in summary


def test_all_good_is_good(parts):
    parts(a=part(""), b=part("", Lane.BUILDS), c=part("", Lane.SIMULATED))
    assert selftest.run(list("abc"), Console(width=100))


def test_a_part_is_told_with_the_processors_time_of_all_its_processes(parts, capfd):
    """Its wall time depends on what runs beside it, and tells little."""
    busy = "import time\nwhile time.process_time() < 0.6: pass"
    child = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {busy!r}])"
    parts(busy=part(child), idle=part("import time; time.sleep(0.5)", Lane.BUILDS))
    assert selftest.run(["busy", "idle"], Console(width=100))
    lines = capfd.readouterr().out.splitlines()
    taken = {line.split()[0]: float(line.split()[-5]) for line in lines if "processor" in line}
    assert taken["busy"] >= 0.6 > 0.4 >= taken["idle"]
    assert taken["all"] == pytest.approx(taken["busy"] + taken["idle"], abs=0.2)


def test_every_part_is_a_command_that_exists():
    for name, made in selftest.PARTS.items():
        command = made.command()
        assert subprocess.run(["which", command[0]], capture_output=True).returncode == 0, name


@pytest.mark.parametrize("lane", [Lane.REAL_TIME, Lane.BUILDS])
def test_a_part_that_hangs_fails_and_the_others_run(parts, monkeypatch, lane, capfd):
    """Also if what it started hangs on, with its output."""
    monkeypatch.setattr(selftest, "LONGEST_PART_S", 1.0)
    sleep = [sys.executable, "-c", "import time; time.sleep(20)"]
    hanging = f"import subprocess; print('begun', flush=True); subprocess.run({sleep!r})"
    parts(hangs=part(hanging, lane), then=part("print('seen')", lane))
    begun = time.monotonic()
    assert not selftest.run(["hangs", "then"], Console(width=100))
    assert time.monotonic() - begun < 15.0
    output = capfd.readouterr().out
    assert "hangs: stopped after 1.0 s" in output and "begun" in output and "seen" in output
