"""Controls from the controller's list: what is shown, what is sent."""

import json
import subprocess
from contextlib import suppress

import numpy as np
import pytest
import viser

from limber import messages
from limber.model.robot import load_robot
from limber.monitor.control import ControlPanel
from limber.monitor.laws import list_laws, parse
from limber.monitor.pending import Pending
from limber.monitor.typed import TypedFields
from limber.monitor.widgets import accepted, make, slider_end
from limber.paths import program, robots_root

JOINTS = [f"joint{i + 1}" for i in range(7)]


@pytest.fixture(scope="module")
def laws():
    return list_laws(robots_root() / "openarm")


@pytest.fixture
def told():
    return []


@pytest.fixture
def typed(served, told):
    return TypedFields(served.link, lambda *words: told.append(words))


class Asked:
    """Stands for Requests."""

    def __init__(self) -> None:
        self.gains_sent, self.modes = [], []

    def gains(self, values, ramp_s):
        assert ramp_s > 0
        self.gains_sent.append(values)

    def mode(self, word):
        self.modes.append(word)


class Running:
    def __init__(self, law: int) -> None:
        status = np.zeros(1, messages.native_dtype_of("controller_status_t"))[0]
        status["law"], status["num_joints"], status["mode"] = law, 7, 4
        status["K_x"] = np.diag([300.0, 300, 300, 15, 15, 15])
        self.newest = {"CONTROLLER_STATUS": status}


def by_browser(handle, value) -> None:
    """As if somebody had moved it on the page."""
    handle._impl.value = value
    for callback in handle._impl.update_cb:
        coroutine = callback(viser.GuiEvent(client=object(), client_id=0, target=handle))
        with suppress(StopIteration):
            coroutine.send(None)


def test_the_list_is_the_controllers(laws):
    listed = json.loads(
        subprocess.run(
            [program("limber-controller"), "--list-laws", "--json"], capture_output=True, text=True
        ).stdout
    )
    assert [law.name for law in laws.laws] == [row["name"] for row in listed["laws"]]
    assert [gain.key for gain in laws.gains] == [row["key"] for row in listed["gains"]]
    assert "cartesian_impedance" in laws.usable
    assert "tomei" not in laws.usable, "it needs joint springs, which this arm has not"
    refused = next(law for law in laws.laws if law.name == "tomei")
    assert "elastic" in refused.refusal
    assert all(law.refusal == "" for law in parse(listed).laws), "no robot: nothing is refused"


def test_labels_have_the_unit_behind_the_name(laws):
    labels = {gain.key: gain.label for gain in laws.gains}
    assert labels["K_x_translation_N_per_m"] == "K x translation N/m"
    assert labels["D_null_Nms_per_rad"] == "D null N m s/rad"
    assert labels["observer_gain_per_s"] == "observer gain 1/s"
    assert labels["velocity_acceleration_rad_per_s2"] == "velocity acceleration rad/s²"


def test_every_listed_gain_has_a_widget_that_shows_its_value(served, laws, typed):
    everything = [*laws.gains, *(gain for law in laws.laws for gain in law.parameters)]
    for gain in everything:
        start = 5.0 if gain.standard == "robot.yaml" else gain.standard
        make(served.gui, gain, start, JOINTS, lambda key, value: None, typed)


def test_a_slider_reaches_some_times_as_far_as_its_value_and_moves_on(served, laws, typed):
    gain = next(gain for gain in laws.gains if gain.key == "K_x_translation_N_per_m")
    assert slider_end(gain, 500.0) == 2000.0
    assert slider_end(gain, 50_000.0) == gain.high
    sent = []
    widget = make(served.gui, gain, 500.0, JOINTS, lambda *change: sent.append(change), typed)
    widget.show([600.0, 5000.0, 700.0])
    assert sent == [], "what is shown is not sent"
    assert widget.values.tolist() == [600.0, 5000.0, 700.0]
    assert widget._each[1].slider.max >= 5000.0


def test_what_a_browser_sends_is_checked(served, laws, typed):
    gain = next(gain for gain in laws.gains if gain.key == "damping_ratio")
    sent = []
    widget = make(served.gui, gain, 0.7, JOINTS, lambda *change: sent.append(change), typed)
    for value in (np.nan, np.inf, -1.0, 2.1):
        assert not accepted(gain, value)
        by_browser(widget.slider, value)
    assert sent == []
    by_browser(widget.slider, 1.0)
    assert sent == [("damping_ratio", 1.0)]


def test_all_and_one_by_one(served, laws, typed):
    gain = next(gain for gain in laws.gains if gain.key == "K_q_Nm_per_rad")
    sent = []
    widget = make(served.gui, gain, [60.0] * 7, JOINTS, lambda *change: sent.append(change), typed)
    by_browser(widget._all.slider, 90.0)
    by_browser(widget._each[2].slider, 30.0)
    assert sent == [
        ("K_q_Nm_per_rad", [90.0] * 7),
        ("K_q_Nm_per_rad", [90.0, 90.0, 30.0, 90.0, 90.0, 90.0, 90.0]),
    ]


def test_the_panel_follows_the_controller_and_sends_what_changes(served, laws, typed):
    asked = Asked()
    number = [law.name for law in laws.laws].index("cartesian_impedance")
    feed = Running(number)
    panel = ControlPanel(served.gui, load_robot("openarm"), laws, asked, feed, typed, Pending())
    panel.draw()
    assert panel.shown_law == "cartesian_impedance"
    shown = panel.widgets["K_x_translation_N_per_m"]
    assert shown.values.tolist() == [300.0] * 3, "the controller's, not robot.yaml's"
    assert asked.gains_sent == []
    by_browser(shown._all.slider, 450.0)
    by_browser(shown._all.slider, 460.0)
    panel.draw()
    (sent,) = asked.gains_sent
    assert sent["K_x_translation_N_per_m"] == [460.0] * 3
    panel.draw()
    assert len(asked.gains_sent) == 1
    feed.newest["CONTROLLER_STATUS"]["law"] = [law.name for law in laws.laws].index("joint_pd")
    panel.settle()
    panel.draw()
    assert panel.shown_law == "joint_pd"
