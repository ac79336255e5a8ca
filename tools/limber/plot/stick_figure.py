"""An arm as a stick figure: lines of text for a terminal, and the points to draw it elsewhere."""

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from limber.arrays import Floats
from limber.model.robot import Robot

DOTS = np.array([[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]])  # of a Braille cell
BLANK = 0x2800


def arm_points(robot: Robot, q: Floats) -> Floats:
    """Base, joints and tip, m in base axes: (n + 2) x 3."""
    frames = robot.dynamics.frames(np.asarray(q, float)[None])
    tip = robot.chain.forward(q)[:3, 3]
    return np.vstack([np.zeros(3), frames.p[:, 0], tip])


@dataclass(frozen=True)
class View:
    """A plane to look at: `right` and `up` are base axes; the window is fixed, so that only the
    arm moves.
    """

    right: Floats
    up: Floats
    low: Floats  # 2, m
    high: Floats  # 2, m

    @staticmethod
    def of(points: Floats, up: Floats, margin_m: float = 0.1) -> "View":
        """Looks at the plane of `up` and that base axis along which the points spread most."""
        up = up / np.linalg.norm(up)
        axes = np.eye(3) - np.outer(np.eye(3) @ up, up)
        sizes = np.linalg.norm(axes, axis=1)
        level = [axis / size for axis, size in zip(axes, sizes, strict=True) if size > 0.5]
        right = max(level, key=lambda axis: np.ptp(points @ axis))
        places = points @ np.column_stack([right, up])
        return View(right, up, places.min(axis=0) - margin_m, places.max(axis=0) + margin_m)

    def project(self, points: Floats) -> Floats:
        places: Floats = points @ np.column_stack([self.right, self.up])
        return places


@dataclass
class Canvas:
    """Dots in a terminal, two by four in each character."""

    columns: int
    rows: int
    cells: NDArray[np.int_] = field(init=False)

    def __post_init__(self) -> None:
        self.cells = np.zeros((self.rows, self.columns), int)

    def line(self, view: View, start: Floats, end: Floats) -> None:
        """Between two points of the view's plane, m."""
        a, b = self._dots(view, start), self._dots(view, end)
        for share in np.linspace(0.0, 1.0, int(np.abs(b - a).max()) + 2):
            self._dot(*np.round(a + share * (b - a)).astype(int))

    def _dots(self, view: View, place: Floats) -> Floats:
        """Both axes to one scale, the window in the middle."""
        size = np.array([2 * self.columns - 1, 4 * self.rows - 1])
        scale = (size / (view.high - view.low)).min()
        centred = (place - 0.5 * (view.low + view.high)) * scale
        return np.array([size[0] / 2 + centred[0], size[1] / 2 - centred[1]])

    def _dot(self, x: int, y: int) -> None:
        if 0 <= x < 2 * self.columns and 0 <= y < 4 * self.rows:
            self.cells[y // 4, x // 2] |= DOTS[y % 4, x % 2]

    def lines(self) -> list[str]:
        return ["".join(chr(BLANK + cell) for cell in row) for row in self.cells]


def draw(view: View, points: Floats, columns: int, rows: int) -> list[str]:
    """Lines of text with the arm in them; joints are small crosses of dots."""
    canvas = Canvas(columns, rows)
    places = view.project(points)
    for start, end in pairwise(places):
        canvas.line(view, start, end)
    size = 0.02 * (view.high - view.low).max()
    for place in places:
        for arm in (np.array([size, 0.0]), np.array([0.0, size])):
            canvas.line(view, place - arm, place + arm)
    return canvas.lines()
