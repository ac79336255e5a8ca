"""A lab run's frames, decoded: nothing is foreign, and values are those of the log."""

import re

import numpy as np
import pytest

from limber.log.reader import Log

SHORT = "duration_s: 0.9\ntimeline:\n  - {at_s: 0.4, mode: hold}\n"


@pytest.fixture(scope="module")
def recorded(limber, tmp_path_factory):
    """Robot -> (folder of the run, lines of its dump)."""
    runs = {}

    def run(robot: str):
        if robot not in runs:
            folder = tmp_path_factory.mktemp(robot)
            scenario = folder / "short.yaml"
            scenario.write_text(
                f"format: limber-scenario/1\nrobot: {robot}\nmode: lockstep\n{SHORT}"
            )
            done = limber("lab", str(scenario), "--can", "--out", str(folder))
            assert done.returncode in (0, 1), done.stderr
            dump = limber("can", "dump", robot, "--file", str(folder / "run.can.log"))
            assert dump.returncode == 0, dump.stderr
            runs[robot] = folder, dump.stdout.splitlines()
        return runs[robot]

    return run


@pytest.mark.parametrize("robot", ["openarm", "planar2r", "testbench", "antagonist2r"])
def test_every_frame_is_known(recorded, robot):
    _, lines = recorded(robot)
    assert len(lines) > 1000
    strange = [line for line in lines if re.search("foreign|unreadable|no registers|SHORT", line)]
    assert not strange, strange[:3]
    times = np.array([float(line.split()[0]) for line in lines])
    assert times[0] == 0 and abs(times[-1] - 0.9) < 0.005
    assert (np.diff(times) >= -1e-3).all()


def test_angles_are_those_of_the_log(recorded):
    """planar2r's drives count turns in float32; sign 1 and no offset."""
    folder, lines = recorded("planar2r")
    angles = np.array(
        [
            2 * np.pi * float(re.search(r"position (\S+) turns", line)[1])
            for line in lines
            if re.search(r" elbow +reply .*position", line)
        ]
    )
    states = Log(folder).read("JOINT_STATE")
    seen = states["theta"][:, 1]
    assert len(angles) > 850
    # Five digits are printed.
    assert np.abs(angles[-500:] - seen[-500:]).max() < 1e-4 * np.abs(seen).max()


def test_stats_of_a_recording(limber, recorded):
    folder, _ = recorded("openarm")
    done = limber("can", "stats", "openarm", "--file", str(folder / "run.can.log"))
    assert done.returncode == 0, done.stderr
    row = re.search(r" 012 +joint2 +reply +(\d+) +(\S+) +(\S+) +(\S+)", done.stdout)
    assert int(row[1]) >= 890
    # And what it tells of its settings: one answer of seven drives every 20 ms.
    assert 998 <= float(row[2]) <= 1002 + 50 / 7
    assert float(row[3]) == pytest.approx(1000 / float(row[2]), abs=0.002)
    measured = float(re.search(r"load (\S+) %", done.stdout)[1])
    predicted = float(re.search(r"predicted at 1000 Hz: (\S+) %", done.stdout)[1])
    assert measured == pytest.approx(predicted, rel=0.03)


def test_replay_refuses_a_bus_that_may_carry_an_arm(limber, recorded):
    folder, _ = recorded("planar2r")
    done = limber(
        "can",
        "replay",
        str(folder / "run.can.log"),
        "planar2r",
        "--bus",
        "arm=socketcan:can0",
    )
    assert done.returncode == 2
    assert "may move it" in done.stderr and "--force" in done.stderr
