"""What the page asks of a hand, and which marks it sets."""

import time
from types import SimpleNamespace

import numpy as np
import pytest
from test_control import by_browser

from limber import messages
from limber.errors import RunError
from limber.live.hand import hand_text
from limber.messages import message_class
from limber.model.robot import load_robot
from limber.monitor import episodes, hand_panel
from limber.monitor.episodes import EpisodePanel
from limber.monitor.feed import Batch
from limber.monitor.hand_panel import HandPanel
from limber.monitor.typed import TypedFields

MARK = message_class("episode_mark_t")


def hand_state(**fields):
    state = np.zeros(1, messages.native_dtype_of("hand_state_t"))[0]
    for name, value in fields.items():
        state[name] = value
    return state


@pytest.fixture
def panel(served, monkeypatch):
    monkeypatch.setattr(hand_panel, "SEND_S", 0.0)
    sent = []
    asked = SimpleNamespace(hand=lambda *goal: sent.append(goal))
    feed = SimpleNamespace(newest={})
    typed = TypedFields(served.link, lambda *_words: None)
    made = HandPanel(served.gui, load_robot("openarm_right").hand, asked, feed, typed)
    return made, sent, feed


def test_a_slider_sends_width_and_force_in_metres_and_newtons(panel):
    made, sent, _ = panel
    made.draw()
    assert sent == [], "what nobody has moved is not sent"
    by_browser(made._widgets["width"].slider, 30.0)
    by_browser(made._widgets["force"].slider, 12.0)
    made.draw()
    made.draw()
    assert sent == [pytest.approx((0.03, 12.0))]
    for value in (-21.0, 89.0, np.nan):
        by_browser(made._widgets["width"].slider, value)
    made.draw()
    assert len(sent) == 1, "beyond the hand"


def test_the_sliders_follow_the_goal_of_others_once_they_rest(panel, monkeypatch):
    made, _, feed = panel
    feed.newest["HAND_STATE"] = hand_state(goal_width_m=0.02, goal_force_N=7, engaged=1)
    by_browser(made._widgets["width"].slider, 50.0)
    made.draw()
    made.draw()
    assert made._widgets["width"].slider.value == 50.0
    monkeypatch.setattr(hand_panel, "SETTLED_S", 0.0)
    made.draw()
    assert made._widgets["width"].slider.value == pytest.approx(20.0)
    assert made._widgets["force"].slider.value == pytest.approx(7.0)


def test_the_hand_in_a_line():
    state = hand_state(width_m=0.0498, force_N=30.02, grasped=1, warm=1, temperature_degC=41.4)
    assert hand_text(state) == "hand 49.8 mm, 30.0 N, grasped, warm, 41 °C"
    assert hand_text(hand_state()) == "hand 0.0 mm, 0.0 N", "a drive that reports no temperature"


class Marks:
    """Stands for Episodes."""

    def __init__(self, _receiver) -> None:
        self.set = []

    def start(self, task):
        self.set.append(task)

    def end(self, success):
        self.set.append(success)

    def drop(self):
        raise RunError("no limber-record <has> kept the mark")


def test_buttons_mark_and_the_line_tells_what_is_kept(served, monkeypatch):
    monkeypatch.setattr(episodes, "Episodes", Marks)
    made = EpisodePanel(served.gui, SimpleNamespace(receiver=None))
    made._task.value = "pick"
    for label in ("start", "success", "failure", "drop"):
        for callback in made.buttons[label]._impl.update_cb:
            callback(None)
    assert made._episodes.set == ["pick", True, False]
    made.draw(Batch())
    assert "no limber-record &lt;has&gt; kept" in made._line.content
    kept = []
    for kind, task in ((MARK.MARK_START, "<b>"), (MARK.MARK_FAILURE, "")):
        message = MARK()
        message.mark, message.task, message.time_ns = kind, task, time.monotonic_ns()
        kept.append(message)
    made.draw(Batch(objects={"EPISODE_KEPT": kept}))
    assert "episode (&lt;b&gt;) ended: failure" in made._line.content
