"""The demo in words, in a terminal of 80 by 24."""

import io

import numpy as np
import pytest
from rich.console import Console

from limber.model.scenario import load_scenario
from limber.paths import ROOT
from limber.plot import stick_figure
from limber.run import story
from limber.run.demo_view import DemoView


@pytest.fixture(scope="module")
def demo():
    return load_scenario(ROOT / "scenarios" / "demo.yaml")


def test_each_event_of_the_demo_has_a_sentence(demo):
    lines = story.story(demo)
    assert [line.time_s for line in lines] == sorted(line.time_s for line in lines)
    told = {line.time_s: line.text for line in lines}
    assert "9 N along +x" in told[2.0] and "500 N/m gives way 18 mm" in told[2.0]
    assert "friction" in told[2.0]
    assert "lets go" in told[4.0]
    assert "dither" in told[4.8]
    assert "500 N/m gives way 18 mm" in told[6.5] and "friction" not in told[6.5]
    assert "off again" in told[17.0]
    assert "wall is put up" in told[17.5]
    assert "70 mm along +x" in told[18.0] and "presses" in told[18.0]
    assert "wall" not in told[22.5], "on its way back"
    assert story.until(lines, 0.1) == []
    assert story.until(lines, 3.0)[-1].time_s == 2.0


def test_without_friction_nothing_is_held_back(demo):
    from dataclasses import replace

    lines = story.story(replace(demo, friction=False))
    assert not any("joint friction" in line.text for line in lines)


def test_only_a_dither_that_ran_is_off_again(demo):
    from dataclasses import replace

    def told(words):
        gains = [
            replace(demo.gains[0], at_s=float(at_s), friction_compensation=word)
            for at_s, word in enumerate(words)
        ]
        lines = story.story(replace(demo, gains=gains, pushes=[]))
        return [(line.time_s, "off" in line.text) for line in lines if "dither" in line.text]

    assert told(["none", "none", "feedforward", "none"]) == []
    assert told(["dither", "dither", "observer"]) == [(2.0, True)]
    assert told(["none", "dither", "none"]) == [(1.0, False), (2.0, True)]


class Receiver:
    def __init__(self, robot) -> None:
        self.records = {
            "JOINT_STATE": {"q": robot.home, "time_ns": 2.5e9},
            "CONTROLLER_STATUS": {"mode": 4, "p_BD": np.array([0.274, 0, 0.5])},
            "SIM_TRUTH": {
                "p_BT": np.array([0.285, 0, 0.5]),
                "F_push": np.array([9.0, 0, 0, 0, 0, 0]),
                "F_contact": np.zeros(6),
            },
        }

    def newest(self, channel):
        return self.records.get(channel)


def test_it_fits_the_terminal(demo):
    receiver = Receiver(demo.robot)
    view = DemoView(receiver, demo)
    for there in (True, False):
        if not there:
            receiver.records.clear()
        console = Console(width=80, record=True, file=io.StringIO())
        console.print(view.render())
        lines = console.export_text().splitlines()
        assert len(lines) <= 22 and max(len(line) for line in lines) <= 80
    receiver.records.update(Receiver(demo.robot).records)
    console = Console(width=80, record=True, file=io.StringIO())
    console.print(view.render())
    text = console.export_text()
    assert "9.0 N" in text and "11.0 mm" in text and "ACTIVE" in text


def test_no_sentence_is_lost_between_two_pictures():
    """In lock step a picture may come after 1.5 s of the arm's time."""
    demo = load_scenario(ROOT / "scenarios" / "demo_short.yaml")
    receiver = Receiver(demo.robot)
    view = DemoView(receiver, demo)
    seen = ""
    for time_s in np.arange(0.7, demo.duration_s, 1.5):
        receiver.records["JOINT_STATE"]["time_ns"] = time_s * 1e9
        console = Console(width=80, record=True, file=io.StringIO())
        console.print(view.render())
        lines = console.export_text().splitlines()
        assert len(lines) == 17, "the picture keeps its height"
        seen += " ".join(line[37:-1].strip(" │") for line in lines) + " "
    for line in view.lines:
        assert line.text in " ".join(seen.split())


def test_a_stick_figure_shows_where_the_arm_is(demo):
    """Two points, a line: every cell between them has dots, no other."""
    view = stick_figure.View(
        np.array([1.0, 0, 0]), np.array([0, 0, 1.0]), np.array([0.0, 0.0]), np.array([1.0, 1.0])
    )
    canvas = stick_figure.Canvas(20, 10)
    canvas.line(view, np.array([0.0, 0.5]), np.array([1.0, 0.5]))
    rows = np.flatnonzero(canvas.cells.any(axis=1))
    assert len(rows) == 1 and canvas.cells[rows[0]].all()
    points = stick_figure.arm_points(demo.robot, demo.robot.home)
    assert points.shape == (len(demo.robot.joints) + 2, 3)
    assert np.allclose(points[-1], demo.robot.chain.forward(demo.robot.home)[:3, 3])
