"""A push lives as long as its browser answers, and a quarter of a second longer."""

import json
import time

import numpy as np
import pytest

from limber import messages
from limber.live.request_messages import SHORTEST_PUSH_S
from limber.model.robot import load_robot
from limber.monitor import push_tool
from limber.monitor.arm_view import ArmView
from limber.monitor.page_link import PageLink
from limber.monitor.push_tool import FORGOTTEN_S, LIFE_S, SEND_S, PushTool
from limber.monitor.shapes import figure
from limber.monitor.typed import TypedFields

ME, OTHER = 1, 2


class Clock:
    def __init__(self) -> None:
        self.now_s = 100.0

    def monotonic(self) -> float:
        return self.now_s


class Feed:
    def __init__(self) -> None:
        self.newest = {"SIM_TRUTH": np.zeros(1, messages.native_dtype_of("sim_truth_t"))[0]}

    def age_s(self, _channel: str) -> float:
        return 0.0


class Asked:
    def __init__(self) -> None:
        self.pushes = []

    def push(self, link, wrench, duration_s):
        self.pushes.append((link, wrench, duration_s))


@pytest.fixture
def clock(monkeypatch):
    made = Clock()
    monkeypatch.setattr(time, "monotonic", made.monotonic)
    return made


@pytest.fixture
def scene(served):
    return ArmView(served.scene, "/arm", figure(load_robot("planar2r")))


@pytest.fixture
def tool(served, scene, clock):
    made = PushTool(
        served.gui,
        scene,
        Feed(),
        Asked(),
        link := PageLink(served.turn),
        TypedFields(link, lambda *_: None),
    )
    made.asked, made.link, made.feed = made._requests, link, made._feed
    return made


def drag(tool, viewer, phase, end=(0.1, 0.0, 0.0)):
    tool.dragged(viewer, tool._arm.figure.links[1], phase, (0.0, 0.0, 0.0), end)


def run(tool, clock, seconds: float, alive: bool, viewer: int = ME) -> list:
    """Draws 30 times a second; the pushes that were asked for."""
    before = len(tool.asked.pushes)
    for _ in range(round(seconds * 30)):
        clock.now_s += 1 / 30
        truth = tool.feed.newest["SIM_TRUTH"]
        truth["time_ns"] += round(1e9 / 30)
        if alive:
            tool.link.note_alive(viewer)
        tool.draw()
    return tool.asked.pushes[before:]


def test_it_is_refreshed_while_the_browser_lives(tool, clock):
    drag(tool, ME, "start")
    pushes = run(tool, clock, 70.0, alive=True)
    assert len(pushes) > 70 / (2 * SEND_S)
    assert all(0 < duration <= LIFE_S for _, _, duration in pushes)
    assert np.allclose(pushes[-1][1][:3], [12.0, 0, 0]), "120 N/m over 0.1 m"


def test_none_outlives_the_last_sign_of_life_by_more_than_a_quarter_second(tool, clock):
    drag(tool, ME, "start")
    run(tool, clock, 2.0, alive=True)
    silent_s, ends = clock.now_s, []
    for _ in range(30):
        clock.now_s += 1 / 30
        before = len(tool.asked.pushes)
        tool.draw()
        ends += [clock.now_s + duration for _, _, duration in tool.asked.pushes[before:]]
    assert ends, "it does not break off at once"
    assert max(ends) <= silent_s + LIFE_S + 1e-9


def test_the_last_moment_of_a_life_is_no_push(tool, clock):
    """A request so short is refused, and the page would tell of a failure."""
    drag(tool, ME, "start")
    run(tool, clock, 1.0, alive=True)
    clock.now_s += LIFE_S - 0.5 * SHORTEST_PUSH_S
    before = len(tool.asked.pushes)
    tool.draw()
    assert tool.asked.pushes[before:] == []


def test_a_page_that_draws_slowly_has_a_second(tool, clock):
    alive = {"viewer": ME, "kind": "alive", "value": {"software": True}}
    assert tool.link._take(json.dumps(alive), set())
    drag(tool, ME, "start")
    run(tool, clock, 1.0, alive=True)
    assert len(run(tool, clock, 0.9, alive=False)) > 10, "between two drawings it goes on"
    assert tool.asked.pushes[-1][2] < 0.2, "until the second is over"
    assert len(run(tool, clock, 0.5, alive=False)) < 3
    assert not tool.link.draws_slowly(OTHER)


def test_the_signs_of_life_of_another_viewer_do_not_keep_it(tool, clock):
    drag(tool, ME, "start")
    run(tool, clock, 1.0, alive=True)
    run(tool, clock, 0.5, alive=True, viewer=OTHER)
    assert run(tool, clock, 2.0, alive=True, viewer=OTHER) == []


def test_a_short_stall_is_no_end_and_a_long_one_is(tool, clock):
    drag(tool, ME, "start")
    run(tool, clock, 1.0, alive=True)
    run(tool, clock, 0.5, alive=False)
    assert run(tool, clock, 0.5, alive=True), "a browser that was busy pushes on"
    run(tool, clock, 2 * FORGOTTEN_S, alive=False)
    assert run(tool, clock, 0.5, alive=True) == []
    drag(tool, ME, "update")
    assert run(tool, clock, 0.5, alive=True) == [], "the hand begins anew"
    drag(tool, ME, "start")
    assert run(tool, clock, 0.5, alive=True)


def test_who_begins_last_pushes_and_only_he_ends_it(tool, clock):
    drag(tool, ME, "start")
    drag(tool, OTHER, "start", end=(0.0, 0.05, 0.0))
    drag(tool, ME, "update")
    drag(tool, ME, "end")
    pushes = run(tool, clock, 0.5, alive=True, viewer=OTHER)
    assert np.allclose(pushes[-1][1][:3], [0, 6.0, 0])
    drag(tool, OTHER, "end")
    assert np.allclose(tool.asked.pushes[-1][1], 0.0)
    assert run(tool, clock, 0.5, alive=True, viewer=OTHER) == []


def test_a_run_faster_than_the_clock_is_pushed_for_as_long_of_the_clock(tool, clock):
    """Pushes are measured in arm time."""
    drag(tool, ME, "start")
    for _ in range(60):
        clock.now_s += 1 / 30
        tool.feed.newest["SIM_TRUTH"]["time_ns"] += round(8e9 / 30)
        tool.link.note_alive(ME)
        tool.draw()
    assert tool.asked.pushes[-1][2] == pytest.approx(8 * LIFE_S, rel=0.1)


def test_numbers_that_are_none_push_nothing(tool, clock):
    drag(tool, ME, "start", end=(np.nan, 0, 0))
    assert run(tool, clock, 0.5, alive=True) == []


def test_the_life_is_what_the_docs_promise():
    assert push_tool.LIFE_S == 0.25
    assert push_tool.SLOW_LIFE_S == 1.0
