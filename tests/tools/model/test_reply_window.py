"""`reply_window_s` of a bus: read from robot.yaml, bounded, and asked for by its full name."""

import json
import shutil
import subprocess

import pytest

from limber.paths import program, robot_folder


@pytest.fixture
def check(tmp_path):
    """limber-check of desktop2r with a line added to its bus."""

    def run(line: str) -> subprocess.CompletedProcess:
        folder = tmp_path / "arm"
        shutil.copytree(robot_folder("desktop2r"), folder, dirs_exist_ok=True)
        path = folder / "robot.yaml"
        text = path.read_text(encoding="utf-8")
        assert text.count("bitrate_bps: 1000000") == 1
        path.write_text(text.replace("bitrate_bps: 1000000", f"bitrate_bps: 1000000{line}"))
        command = [str(program("limber-check")), "robot", str(folder), "--json"]
        return subprocess.run(command, capture_output=True, text=True, check=False)

    return run


def window_s(done: subprocess.CompletedProcess) -> float:
    assert done.returncode == 0, done.stderr
    (bus,) = json.loads(done.stdout)["buses"]
    return bus["reply_window_s"]


def test_it_is_the_window(check):
    predicted = window_s(check(""))
    assert window_s(check(", reply_window_s: 0.0008")) == 0.0008 != predicted
    assert window_s(check(", reply_window_s: 0.0003")) == 0.0003


@pytest.mark.parametrize(
    "line, told",
    [
        (", reply_window_s: 0", "reply_window_s"),
        (", reply_window_s: 2", "reply_window_s"),
        (", reply_window: 0.001", "did you mean 'reply_window_s'"),
    ],
)
def test_what_cannot_be_is_refused(check, line, told):
    done = check(line)
    assert done.returncode == 2
    assert told in done.stderr
