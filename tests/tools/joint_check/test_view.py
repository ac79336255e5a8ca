"""What the live table shows, and what a pipe gets instead."""

import io

import numpy as np
import pytest
from rich.console import Console

from limber.joint_check.judge import Step
from limber.joint_check.screen import STAYS_S, Screen
from limber.joint_check.view import awaited, bar, picture

NAMES = ["turn", "slide"]


def at_rest() -> Step:
    step = Step(0, 1, np.array([0.2, 0.02]))
    for i in range(12):
        step.take(0.05 * i, np.array([0.5, 0.1]), np.ones(2, bool))
    return step


def text_of(step: Step) -> str:
    console = Console(width=100, file=io.StringIO())
    console.print(picture(NAMES, [False, True], step, ["do this", "awaited", "keys"]))
    return console.file.getvalue()


def test_angle_change_and_bar():
    step = at_rest()
    step.take(0.65, np.array([0.6, 0.096]), np.ones(2, bool))
    lines = text_of(step).splitlines()
    turn = next(line for line in lines if "turn" in line)
    slide = next(line for line in lines if "slide" in line)
    assert "►" in turn and "+0.600 rad" in turn and "+0.100 rad" in turn
    assert "►" not in slide and "+0.096 m" in slide and "-0.004 m" in slide
    assert turn.split()[-1] == "──────────┼█████─────"
    assert slide.split()[-1] == "────────██┼──────────"


@pytest.mark.parametrize(
    ("share", "way", "style"),
    [
        (0.5, 1, "green"),
        (-0.5, 1, "bold red"),
        (-0.5, -1, "green"),
        (0.5, 0, "yellow"),
        (0.1, 0, "dim"),
    ],
)
def test_colours(share, way, style):
    assert bar(share, way).style == style


def test_a_bar_has_an_end():
    assert bar(7.0, 1).plain == "──────────┼██████████"
    assert bar(-7.0, 1).plain == "██████████┼──────────"


def test_before_the_arm_is_at_rest_there_is_no_change():
    step = Step(0, 1, np.array([0.2, 0.02]))
    step.take(0.0, np.array([0.5, 0.1]), np.ones(2, bool))
    assert "┼" not in text_of(step)
    assert awaited(NAMES, step) == "Waiting until the arm is at rest."
    step.take(0.1, np.array([0.5, 0.2]), np.ones(2, bool))
    assert awaited(NAMES, step) == "Waiting until the arm is at rest: slide moves."


def test_a_joint_without_reading_is_named():
    step = at_rest()
    assert awaited(NAMES, step) == "Waiting for your hand."
    step.take(0.65, np.array([0.6, np.nan]), np.ones(2, bool))
    assert awaited(NAMES, step) == "Waiting for fresh readings of slide."
    assert "no reading" in text_of(step)


def test_without_a_terminal_words_come_once_if_they_stay(monkeypatch):
    now = [0.0]
    monkeypatch.setattr("limber.joint_check.screen.time.monotonic", lambda: now[0])
    out = io.StringIO()
    with Screen(Console(file=out, width=100)) as screen:
        screen.show("picture", "briefly")
        for _ in range(3):
            screen.show("picture", "for long")
            now[0] += STAYS_S
        screen.show("picture", "task", at_once=True)
        screen.tell("several")
        screen.show("picture", "task", at_once=True)
    assert out.getvalue().splitlines() == ["for long", "task", "several", "task"]
