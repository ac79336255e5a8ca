"""A log with damaged bytes is measured as far as it is sound, or refused; never worse."""

import json
import random
import struct

import numpy as np
import pytest
from test_measure import driver_of, state_of, timeline, truth_of, write_log

from limber.errors import LimberError
from limber.log.reader import Log
from limber.measure.sound import sound
from limber.measure.summarize import measure

DAMAGED = 150
NUMBERS = [np.nan, np.inf, -np.inf, 1e308, -0.0]


@pytest.fixture
def pushed(scenario):
    return scenario("openarm", "friction: false\n" + timeline(("+x",)))


def channels_of(scenario) -> dict[str, np.ndarray]:
    truth = truth_of(scenario, np.linalg.inv(scenario.robot.K_x))
    state, driver = state_of(truth), driver_of(truth)
    return {"SIM_TRUTH": truth, "JOINT_STATE": state, "DRIVER_STATUS": driver}


def saved(path, scenario, folder) -> dict:
    """Strictly read: NaN and Infinity are no JSON."""
    summary, _ = measure(Log(path), scenario, "lockstep")
    summary.save(folder / "summary.json")
    summary.table("")

    def refuse(word):
        raise AssertionError(f"{word} in summary.json")

    text = (folder / "summary.json").read_text(encoding="utf-8")
    return json.loads(text, parse_constant=refuse)


def damaged(good: bytes, seed: int) -> bytes:
    """A few changes: bytes overwritten, left out, doubled, numbers that are none."""
    choose = random.Random(seed)
    data = bytearray(good)
    for _ in range(choose.randint(1, 30)):
        at = choose.randrange(len(data) - 100)
        kind = choose.randrange(4)
        if kind == 0:
            data[at] = choose.randrange(256)
        elif kind == 1:
            data[at : at + 8] = struct.pack(">d", choose.choice(NUMBERS))
        elif kind == 2:
            del data[at : at + choose.randrange(1, 60)]
        else:
            data[at:at] = data[at : at + choose.randrange(1, 60)]
    return bytes(data)


def test_damage_anywhere(tmp_path, pushed):
    good = write_log(tmp_path / "good.lcmlog", channels_of(pushed)).read_bytes()
    refused = 0
    for seed in range(DAMAGED):
        path = tmp_path / "run.lcmlog"
        path.write_bytes(damaged(good, seed))
        try:
            saved(path, pushed, tmp_path)
        except LimberError:
            refused += 1
    assert refused < DAMAGED / 2


@pytest.mark.parametrize("field", ["p_BT", "q", "F_push", "quat_BT"])
def test_a_number_that_is_none_is_left_out(tmp_path, pushed, field):
    """A few messages in a long push change nothing that can be seen."""
    channels = channels_of(pushed)
    before = saved(write_log(tmp_path / "good.lcmlog", channels), pushed, tmp_path)
    channels["SIM_TRUTH"][field][100:400:100] = 0.7 if field == "quat_BT" else np.nan
    after = saved(write_log(tmp_path / "bad.lcmlog", channels), pushed, tmp_path)
    values = [{r["name"]: r["value"] for r in run["results"]} for run in (before, after)]
    assert values[1]["stiffness +x"] == pytest.approx(values[0]["stiffness +x"], rel=1e-6)
    assert values[1]["messages with impossible numbers"] == 3 and not after["pass"]
    assert "messages with impossible numbers" not in values[0] and before["pass"]


def test_sound_keeps_what_is_sound(pushed):
    truth = channels_of(pushed)["SIM_TRUTH"]
    assert len(sound(truth)) == len(truth)
    assert len(sound(truth[:0])) == 0


def test_a_tip_that_does_not_move_has_no_number(tmp_path, pushed):
    channels = channels_of(pushed)
    channels["SIM_TRUTH"]["p_BT"][:] = [0.5, 0, 0.5]
    results = saved(write_log(tmp_path / "stiff.lcmlog", channels), pushed, tmp_path)["results"]
    (stiffness,) = [r for r in results if r["name"] == "stiffness +x"]
    assert stiffness["value"] is None and stiffness["pass"] is False
