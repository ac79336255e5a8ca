"""Pushes the simulated arm: a link that is dragged is pulled by a spring to the pointer."""

import time
from dataclasses import dataclass

import numpy as np
import viser
from numpy.typing import ArrayLike

from limber.live.request_messages import SHORTEST_PUSH_S
from limber.monitor.arm_view import ArmView
from limber.monitor.feed import Feed
from limber.monitor.page_link import PageLink
from limber.monitor.requests import Requests
from limber.monitor.typed import Field, TypedFields

STYLE = "font-size:0.85em;margin:2px 12px 6px 12px"
HOW = f'<div style="{STYLE}">Drag a link of the arm with the mouse to push it.</div>'
NOBODY = f'<div style="{STYLE}">No simulator: a real arm is pushed by hand.</div>'

SEND_S = 0.05
LIFE_S = 0.25  # a push ends so long after the last sign of life of its browser
SLOW_LIFE_S = 1.0  # likewise, where the browser draws without a graphics card: 0.6 s were seen
FORGOTTEN_S = 2.0  # a browser that was away for longer begins anew
FASTEST = 12.0  # times real time: arm time of a run that waits for no clock
STRONGEST_N = 60.0


@dataclass(frozen=True)
class Pull:
    """By a viewer's pointer, from where the link was gripped to where the pointer is, m."""

    viewer: int
    link: str
    start: np.ndarray
    end: np.ndarray


class PushTool:
    def __init__(
        self,
        gui: viser.GuiApi,
        arm: ArmView,
        feed: Feed,
        requests: Requests,
        link: PageLink,
        typed: TypedFields,
    ) -> None:
        self._arm, self._feed, self._requests, self._link = arm, feed, requests, link
        self._pull: Pull | None = None
        self._sent_s = 0.0
        self._pace = Pace()
        self._text = gui.add_html("")
        self._stiffness = gui.add_slider("push N/m", 20.0, 400.0, 10.0, 120.0)
        self._strongest = gui.add_slider("at most N", 1.0, STRONGEST_N, 1.0, 30.0)
        for slider in (self._stiffness, self._strongest):
            typed.add(Field(slider, slider.label, slider.min, slider.max, lambda _value: None))
        for shape, handle in arm.meshes:
            self._bind(handle, shape.link)

    def _bind(self, handle: viser.MeshHandle, link: str) -> None:
        @handle.on_drag("left")
        async def _(event: viser.SceneNodeDragEvent) -> None:
            self.dragged(
                event.client_id, link, event.phase, event.start_position, event.end_position
            )

    def dragged(self, viewer: int, link: str, phase: str, start: ArrayLike, end: ArrayLike) -> None:
        """Another viewer's drag takes over with its start; the end is its own alone."""
        mine = self._pull is not None and self._pull.viewer == viewer
        if phase == "end":
            if mine:
                self._pull = None
                self._requests.push(self._arm.link_name(link), np.zeros(6), 0.01)
            return
        if phase != "start" and not mine:
            return
        pull = Pull(viewer, link, np.array(start, float), np.array(end, float))
        if np.isfinite(pull.start).all() and np.isfinite(pull.end).all():
            self._link.note_alive(viewer)
            self._pull = pull

    def draw(self) -> None:
        """Refreshes the push for as long as the browser lives; else it ends by itself."""
        now, pull = time.monotonic(), self._pull
        there = self._feed.age_s("SIM_TRUTH") < 0.5
        self._pace.note(now, self._feed.newest.get("SIM_TRUTH"))
        self._text.content = HOW if there else NOBODY
        if pull is None or not there or now - self._sent_s < SEND_S:
            return
        silent_s = self._link.silent_s(pull.viewer)
        if silent_s > FORGOTTEN_S:
            self._pull = None
        life_s = SLOW_LIFE_S if self._link.draws_slowly(pull.viewer) else LIFE_S
        if life_s - silent_s < SHORTEST_PUSH_S:
            return
        self._sent_s = now
        duration_s = (life_s - silent_s) * self._pace.rate
        self._requests.push(self._arm.link_name(pull.link), self._wrench(pull), duration_s)

    def _wrench(self, pull: Pull) -> np.ndarray:
        """At the origin of the link, or of the tip, which the last link stands for."""
        force = float(self._stiffness.value) * (pull.end - pull.start)
        size = float(np.linalg.norm(force))
        limit = float(self._strongest.value)
        if size > limit:
            force *= limit / size
        lever = pull.start - self._arm.origin(pull.link)
        return np.concatenate([force, np.cross(lever, force)])


class Pace:
    """How fast arm time passes against the clock: pushes are measured in arm time."""

    OVER_S = 0.5

    def __init__(self) -> None:
        self._before: tuple[float, float] | None = None  # clock and arm time, s
        self.rate = 1.0

    def note(self, now_s: float, truth: np.void | None) -> None:
        if truth is None:
            return
        arm_s = float(truth["time_ns"]) * 1e-9
        if self._before is None or arm_s < self._before[1]:
            self._before = now_s, arm_s
        elif now_s - self._before[0] > self.OVER_S:
            rate = (arm_s - self._before[1]) / (now_s - self._before[0])
            # a run that stood still may go on at its full pace: a push must not break off then
            self.rate = float(np.clip(rate, 1.0, FASTEST))
            self._before = now_s, arm_s
