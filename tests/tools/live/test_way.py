"""The modes and the ways between them are those of the controller."""

import re
from pathlib import Path

import pytest

from limber.errors import InputError
from limber.live.meant import check_entry, check_lengths, meant
from limber.live.request_messages import goal
from limber.live.values import one_of
from limber.live.way import LEADS_TO, TAKES, in_words, way_from

TABLE = Path(__file__).resolve().parents[3] / "controller" / "modes" / "mode_table.cc"


def test_the_table_is_the_controllers():
    rows = re.findall(
        r"\{Mode::k(\w+), Event::kRequest(\w+), Mode::k(\w+),", TABLE.read_text(encoding="utf-8")
    )
    name = {"SoftStop": "SOFT_STOP"}
    takes = {mode: set() for mode in TAKES}
    for start, request, end in rows:
        start, end = (name.get(mode, mode.upper()) for mode in (start, end))
        if request != "Stop" and start != end:
            takes[start].add(request.lower())
            # HOLD from ACTIVE comes behind SOFT_STOP
            assert LEADS_TO[request.lower()] == end.replace("SOFT_STOP", "HOLD")
    assert {mode: set(requests) for mode, requests in TAKES.items()} == takes


@pytest.mark.parametrize(
    ("mode", "wanted", "way"),
    [
        ("FAULT", "active", ["acknowledge", "hold", "active"]),
        ("ESTOP", "idle", ["acknowledge", "hold", "idle"]),
        ("FAULT", "hold", ["acknowledge", "hold"]),
        ("IDLE", "active", ["hold", "active"]),
        ("HOLD", "active", ["active"]),
        ("ACTIVE", "idle", ["hold", "idle"]),
        ("SOFT_STOP", "active", []),
        ("BOOT", "hold", []),
    ],
)
def test_the_fewest_requests(mode, wanted, way):
    assert way_from(mode, wanted) == way


def test_a_refusal_names_request_mode_and_way():
    words = in_words("FAULT", "active")
    assert "active is not taken in FAULT" in words and "acknowledge, hold, active" in words
    assert "hold, active" in in_words("IDLE", "goal"), "a goal needs ACTIVE"
    assert "comes to rest" in in_words("SOFT_STOP", "active")
    assert "good states" in in_words("INIT", "hold")


KNOWN = {"entries": ["mode", "gains", "goal"], "gains": ["law", "damping_ratio"]}


@pytest.mark.parametrize(
    ("entry", "hint"),
    [
        ("stiffness: 200", "K_x_translation_N_per_m"),
        ("impedance", "law: cartesian_impedance"),
        ("gains: {stiffness: 200}", "K_x_translation_N_per_m"),
        ("gains: {damping: 0.7}", "damping_ratio"),
        ("goal: {offset_m: [0, 0, 50]}", "write 0.05"),
        ("goal: {position_m: [300, 0, 0], quaternion_wxyz: [1, 0, 0, 0]}", "write 0.3"),
        ("stop", "mode: stop"),
    ],
)
def test_words_of_elsewhere_and_millimetres_are_answered_with_what_is_meant(entry, hint):
    with pytest.raises(InputError, match=re.escape(hint)):
        check_entry(entry, KNOWN)


@pytest.mark.parametrize(
    "entry",
    [
        "mode: active",
        "gains: {damping_ratio: 0.7}",
        "goal: {offset_m: [0, 0, 0.05]}",
        "{",
        "5",
        "goal: {offset_m: much}",
        "gains: {colour: 1}",
        "goal: {joints_rad: [12, 0]}",
    ],
)
def test_all_else_is_left_to_who_reads_it(entry):
    check_entry(entry, KNOWN)


def test_python_is_told_the_same():
    with pytest.raises(InputError, match=r"offset_m: 50 m .* write 0\.05"):
        goal(7, offset_m=[0, 0, 50])
    with pytest.raises(InputError, match="'cartesian_impedance' or 'joint_impedance'"):
        one_of("law", "impedance", ["cartesian_impedance", "admittance", "joint_impedance"])
    with pytest.raises(InputError, match="K_x_translation"):
        one_of("the gain", "stiffness", ["damping_ratio", "tank_J"])
    check_lengths({"position_m": [float("inf"), 0, 0]})  # refused elsewhere, as no number
    assert meant("colour") == ""
