"""Episodes of a recording: marked from Python, by key and by anybody, read again as a dataset."""

import json
import os
import pty
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from processes import started

from limber import Arm
from limber.errors import RunError
from limber.live.episodes import Episodes
from limber.live.line import Line
from limber.live.receiver import Receiver
from limber.log.episodes import episodes
from limber.log.reader import Log
from recorders import recording
from stack import USER_URL

parquet = pytest.importorskip("pyarrow.parquet", reason="comes with ./limber test")


def limber(*arguments: str) -> str:
    command = [sys.executable, "-m", "limber", *arguments]
    done = subprocess.run(command, timeout=300, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_three_episodes_become_a_dataset_of_two(standing, tmp_path):
    """Each turns the first joint by its own angle; the one in the middle is dropped."""
    path = tmp_path / "picks.lcmlog.zst"
    turns = {"pick": 0.1, "drop me": -0.1, "place": 0.2}
    with Arm() as arm, arm.record(path):
        arm.activate()
        home = arm.q
        for task, turn in turns.items():
            aim = home + turn * (np.arange(7) == 0)
            arm.chunk(0.5, joints_rad=np.stack([arm.q, aim, aim]))
            arm.episodes.start(task)
            arm.wait(for_s=1.0)
            arm.episodes.end(success=task == "place")
            if task == "drop me":
                arm.episodes.drop()
    shown = limber("log", "episodes", str(path), "--plot", str(tmp_path / "picks.png"))
    assert "drop me" in shown and "dropped" in shown
    assert (tmp_path / "picks.png").read_bytes().startswith(b"\x89PNG")
    assert "episode 3 (place): success" in limber("log", "events", str(path))
    out = tmp_path / "dataset"
    told = limber("log", "convert", str(path), "--to", "lerobot", "--out", str(out))
    assert "episode 2 is left out: dropped" in told
    meta = parquet.read_table(out / "meta/episodes/chunk-000/file-000.parquet").to_pydict()
    assert meta["tasks"] == [["pick"], ["place"]] and meta["success"] == [False, True]
    data = parquet.read_table(out / "data/chunk-000/file-000.parquet").to_pydict()
    assert json.loads((out / "meta/info.json").read_text())["total_frames"] == len(data["index"])
    first = np.array(data["action"])[:, 0]
    of = np.array(data["episode_index"])
    for i, turn in enumerate((0.1, 0.2)):
        aimed = first[of == i][-1]
        assert aimed == pytest.approx(np.degrees(home[0] + turn), abs=np.degrees(0.02))
    limber("log", "episodes", str(path), "--keep", "2", "--drop", "1")
    again = tmp_path / "again"
    limber("log", "convert", str(path), "--to", "lerobot", "--out", str(again))
    meta = parquet.read_table(again / "meta/episodes/chunk-000/file-000.parquet").to_pydict()
    assert meta["tasks"] == [["drop me"], ["place"]]


@pytest.fixture
def marks():
    receiver = Receiver("EPISODE_KEPT")
    yield Episodes(receiver)
    receiver.close()


@pytest.mark.parametrize("name", ["run.lcmlog", "run.lcmlog.zst"])
def test_a_mark_outlives_the_recorder(marks, tmp_path, name):
    """It is killed as soon as the mark is confirmed."""
    path = tmp_path / name
    with recording(path) as recorder:
        marks.start("pick")
        marks.end(success=True)
        recorder.kill()
        recorder.wait()
    found = episodes(Log(path))
    assert [(one.task, one.outcome) for one in found] == [("pick", "success")]


def test_without_a_recorder_a_mark_is_an_error(marks, monkeypatch):
    monkeypatch.setattr("limber.live.episodes.KEPT_S", 1.0)
    with pytest.raises(RunError, match="no limber-record"):
        marks.start("pick")


def test_a_mark_while_the_recorder_is_held_up_comes_later_and_once(marks, tmp_path, monkeypatch):
    monkeypatch.setattr("limber.live.episodes.KEPT_S", 1.0)
    path = tmp_path / "run.lcmlog"
    with recording(path) as recorder:
        marks.start("pick")
        recorder.send_signal(signal.SIGSTOP)
        with pytest.raises(RunError, match="no limber-record"):
            marks.end(success=True)
        recorder.send_signal(signal.SIGCONT)
        marks.drop()
        recorder.terminate()
        recorder.wait(timeout=300)
    log = Log(path)
    assert len(log.raw("EPISODE")) > 3, "sent again and again"
    (one,) = episodes(log)
    assert (one.outcome, one.dropped) == ("success", True)


def test_garbled_marks_are_recorded_and_not_confirmed(marks, tmp_path):
    path = tmp_path / "run.lcmlog"
    line = Line(USER_URL)
    with recording(path) as recorder:
        marks.start("pick")
        good = Log(path).raw("EPISODE")[0]
        garbled = [good[:-3], good + b"\0", b"", bytes(100), good[:32] + b"\x63" + good[33:]]
        for data in garbled:
            line.publish("EPISODE", data)
        marks.end(success=False)
        recorder.terminate()
        assert recorder.wait(timeout=300) == 0
    line.close()
    log = Log(path)
    assert [data for data in log.raw("EPISODE") if data in garbled] == garbled
    assert len(set(log.raw("EPISODE_KEPT"))) == 2  # a busy machine has a mark sent again
    assert [one.outcome for one in episodes(log)] == ["failure"]
    assert "no mark of an episode" in path.with_suffix(".txt").read_text()


def test_by_key(tmp_path):
    path = tmp_path / "keys.lcmlog"
    ours, theirs = pty.openpty()
    command = [sys.executable, "-m", "limber", "record", "--out", str(path)]
    command += ["--episodes", "--task", "pick"]
    with started(command, stdin=theirs, stdout=subprocess.PIPE, text=True) as record:
        assert "recording to" in record.stdout.readline()
        for key, word in (("s", "started"), ("y", "success"), ("s", "started"), ("n", "failure")):
            time.sleep(0.1)
            os.write(ours, key.encode())
            assert record.stdout.readline() == f"{word}\n"
        os.write(ours, b"dq")
        rest = record.stdout.read()
        assert record.wait(timeout=300) == 0
    os.close(ours)
    os.close(theirs)
    assert rest.startswith("dropped\n") and rest.count("pick") == 2
    found = [(one.task, one.outcome, one.dropped) for one in episodes(Log(path))]
    assert found == [("pick", "success", False), ("pick", "failure", True)]
