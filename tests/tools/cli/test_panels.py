"""`limber --help` by what a person wants."""

import re

import pytest
from typer.main import get_command

from limber.cli.main import IN_A_CLONE, app
from limber.cli.panels import ELSEWHERE, PANELS, PLACES


def test_every_command_has_its_panel_and_no_panel_a_ghost():
    assert set(get_command(app).commands) == set(PLACES) | set(IN_A_CLONE) | {"law"}
    assert len(PLACES) == sum(map(len, PANELS.values())), "none stands in two"
    assert len(PLACES) <= 15


@pytest.mark.parametrize(("before", "now"), ELSEWHERE.items())
def test_the_words_before_still_work(before, now):
    """They reach the very command that has another place now."""
    commands = get_command(app)
    group, _, inside = now.partition(" ")
    assert commands.get_command(None, before) is commands.commands[group].commands[inside]
    assert before not in commands.list_commands(None)


def test_the_panels_stand_in_the_order_of_a_persons_way(limber):
    shown = limber("--help").stdout
    assert "limber law" in shown, "below the panels"
    places = [shown.index(panel) for panel in PANELS]
    assert places == sorted(places)
    for panel, names in PANELS.items():
        block = shown[shown.index(panel) :].split("╰")[0]
        listed = re.findall(r"^│ (\w+) ", block, re.MULTILINE)
        assert tuple(listed) == names


def test_words_that_are_no_commands_are_answered_with_the_command(limber):
    for word, hint in (("stiffness", "K_x_translation_N_per_m"), ("stop", "mode: stop")):
        done = limber(word)
        assert done.returncode == 2
        assert f"No such command '{word}'" in done.stderr and hint in done.stderr
    assert "See limber --help" in limber("xyzzy").stderr
