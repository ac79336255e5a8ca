"""The demo in a terminal of 80 by 24: the arm from the side, what happens to it, and how it gives
way.
"""

import textwrap

import numpy as np
from rich.console import Group
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from limber import messages
from limber.live.receiver import Receiver
from limber.model.scenario import Scenario
from limber.plot import stick_figure
from limber.run import story

SHOWN = ("JOINT_STATE", "CONTROLLER_STATUS", "SIM_TRUTH")
FIGURE = (32, 14)  # columns, rows
WORDS = (38, 15)  # the other panel's text: columns, rows
LONGEST_mm = 40.0
GOOD, WARN = "green", "yellow"


class DemoView:
    def __init__(self, receiver: Receiver, scenario: Scenario) -> None:
        self.receiver = receiver
        self.scenario = scenario
        self.lines = story.story(scenario)
        robot = scenario.robot
        points = stick_figure.arm_points(robot, robot.home)
        self.window = stick_figure.View.of(points, -robot.gravity)

    def render(self) -> Table:
        state = self.receiver.newest("JOINT_STATE")
        status = self.receiver.newest("CONTROLLER_STATUS")
        truth = self.receiver.newest("SIM_TRUTH")
        row = Table.grid(padding=(0, 1))
        figure = Group(*self._figure(state))
        numbers = self._numbers(status, truth)
        happens = self._happens(state, WORDS[1] - 1 - len(numbers))
        words = Group(*happens, Text(), *numbers)
        row.add_row(
            Panel(figure, title="the arm, from the side", width=FIGURE[0] + 4, height=WORDS[1] + 2),
            Panel(words, title="what happens", width=WORDS[0] + 4, height=WORDS[1] + 2),
        )
        return row

    def _figure(self, state: np.void | None) -> list[Text]:
        robot = self.scenario.robot
        q = robot.home if state is None else state["q"][: len(robot.joints)]
        points = stick_figure.arm_points(robot, q)
        return [Text(line) for line in stick_figure.draw(self.window, points, *FIGURE)]

    def _happens(self, state: np.void | None, rows: int) -> list[Text]:
        """The latest sentences that fit. Lock step may go through several between two pictures."""
        if state is None:
            return [Text("starting ...", style=WARN)]
        told = story.until(self.lines, float(state["time_ns"]) * 1e-9)
        if not told:
            return [Text("The motors are being found on the bus.")]
        *before, newest = told
        happens = [Text(f"{newest.time_s:.1f} s", style="dim"), Text(newest.text)]
        rows -= 1 + _rows(newest.text)
        for line in reversed(before):
            rows -= _rows(line.text)
            if rows < 0:
                break
            happens.insert(0, Text(line.text, style="dim"))
        return happens

    def _numbers(self, status: np.void | None, truth: np.void | None) -> list[Text]:
        if status is None or truth is None:
            return []
        modes = messages.constants("controller_status_t", "MODE_")
        mode = modes.get(int(status["mode"]), "?")
        away = (truth["p_BT"] - status["p_BD"]) * 1e3
        push = truth["F_push"][:3]
        wall = truth["F_contact"][:3]
        lines = [
            Text.assemble("mode     ", (mode, GOOD if mode in ("HOLD", "ACTIVE") else WARN)),
            _bar("away", float(np.linalg.norm(away)), "mm", LONGEST_mm),
            _bar("pushed", float(np.linalg.norm(push)), "N", 20.0),
            _bar("wall", float(np.linalg.norm(wall)), "N", 20.0),
        ]
        if np.any(push):
            direction = push / np.linalg.norm(push)
            moved = float(away @ direction)
            lines.append(Text(f"         {moved:.1f} mm along the push", style="dim"))
        return lines


def _rows(text: str) -> int:
    return len(textwrap.wrap(text, WORDS[0]))


def _bar(name: str, value: float, unit: str, most: float) -> Text:
    """A number and how long it is, in 14 characters."""
    filled = round(min(max(value / most, 0.0), 1.0) * 14)
    return Text.assemble(f"{name:<8} ", (f"{value:6.1f} {unit:<2} ", "bold"), ("█" * filled, GOOD))
