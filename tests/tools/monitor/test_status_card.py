"""The box at the top: one cause, its cure, and the buttons of the way back."""

import re

import pytest

from limber.live.way import TAKES, WAY
from limber.monitor.status_card import Shown, card
from limber.monitor.words import BAD, WARN, Note, Situation

LOST = Note(BAD, "driver.REPLY_LOST (elbow)", "No reply.", "Check power.")


def box(mode: str, notes=(), control=True, **more) -> str:
    level = BAD if mode == "FAULT" else WARN
    return card(Shown(Situation(level, mode, "", list(notes), mode), control=control, **more))[0]


def buttons(html: str) -> dict[str, str]:
    return {word: rest for word, rest in re.findall(r'data-limber="(\w+)"([^>]*)>', html)}


def test_a_fault_is_one_box_with_cause_cure_and_the_way_back():
    html = box("FAULT", [LOST, Note(BAD, "controller.DRIVER_FAULT", "It left.", "Cure it.")])
    assert html.index("REPLY_LOST") < html.index("Check power") < html.index("acknowledge")
    assert "DRIVER_FAULT" not in html, "what follows from the cause stands below the box"
    assert list(buttons(html))[:3] == list(WAY)


@pytest.mark.parametrize("mode", TAKES)
def test_a_button_that_cannot_act_is_disabled(mode):
    found = buttons(box(mode))
    can = {word for word, rest in found.items() if "disabled" not in rest} - {"release"}
    assert can == set(TAKES[mode])


@pytest.mark.parametrize(
    ("mode", "word"), [("IDLE", "idle"), ("HOLD", "hold"), ("ACTIVE", "active")]
)
def test_the_present_mode_is_marked(mode, word):
    marked = [w for w, rest in buttons(box(mode)).items() if "aria-current" in rest]
    assert marked == [word]


def test_no_mode_no_buttons():
    """A silent controller takes none."""
    assert buttons(box("")) == {}


def test_without_control_the_box_names_who_can():
    html = box("FAULT", [LOST], control=False)
    assert buttons(html) == {} and "limber send recover" in html


def test_gains_to_come_stand_above_the_buttons():
    html = box("FAULT", [LOST], pending=["K_x: 900 (now 300)"])
    assert html.index("900 (now 300)") < html.index("<button")


def test_nothing_from_outside_becomes_markup():
    evil = "<img src=x onerror=alert(1)>"
    note = Note(BAD, f"driver.POSITION ({evil})", evil, evil)
    shown = Shown(
        Situation(BAD, evil, evil, [note, note], "FAULT"), [evil], [evil], [evil], [note], True
    )
    assert "<img" not in "".join(card(shown))


def test_hand_and_targets_stand_below_the_facts():
    lines = ["hand 50 mm", "targets <running>"]
    _, facts, _ = card(Shown(Situation(WARN, "ACTIVE", ""), facts=["a law"], lines=lines))
    assert facts.index("a law") < facts.index("hand 50 mm") < facts.index("&lt;running&gt;")
