"""Pushes the simulated arm: a link that is dragged is pulled by a spring to the pointer."""

import time

import numpy as np
import viser

from limber.monitor.arm_view import ArmView
from limber.monitor.feed import Feed
from limber.monitor.requests import Requests

SEND_S = 0.05
PUSH_S = 0.25  # a push that is not refreshed ends by itself
LONGEST_S = 60.0  # without a word from the browser
LOCKSTEP_S = 3.0  # arm time may pass faster than the clock; else a push ends soon by itself
STRONGEST_N = 60.0


class PushTool:
    def __init__(self, gui: viser.GuiApi, arm: ArmView, feed: Feed, requests: Requests) -> None:
        self._arm, self._feed, self._requests = arm, feed, requests
        self._pull: tuple[str, np.ndarray, np.ndarray] | None = None  # link, from, to
        self._heard_s = self._sent_s = 0.0
        self._text = gui.add_markdown("Drag a link of the arm with the mouse to push it.")
        self._stiffness = gui.add_slider("push N/m", 20.0, 400.0, 10.0, 120.0)
        self._strongest = gui.add_slider("at most N", 1.0, STRONGEST_N, 1.0, 30.0)
        for shape, handle in arm.meshes:
            self._bind(handle, shape.link)

    def _bind(self, handle: viser.MeshHandle, link: str) -> None:
        @handle.on_drag("left")
        async def _(event: viser.SceneNodeDragEvent) -> None:
            self._heard_s = time.monotonic()
            if event.phase == "end":
                self._pull = None
                self._requests.push(self._arm.link_name(link), np.zeros(6), 0.01)
                return
            start, end = np.array(event.start_position), np.array(event.end_position)
            if np.isfinite(start).all() and np.isfinite(end).all():
                self._pull = link, start, end

    def draw(self) -> None:
        """Refreshes the push, which else ends by itself: also if the browser dies."""
        now, pull = time.monotonic(), self._pull
        there = self._feed.age_s("SIM_TRUTH") < 0.5
        self._text.content = (
            "Drag a link of the arm with the mouse to push it."
            if there
            else "No simulator: a real arm is pushed by hand."
        )
        if pull is None or not there or now - self._sent_s < SEND_S:
            return
        if now - self._heard_s > LONGEST_S:
            self._pull = None
            return
        self._sent_s = now
        link, start, end = pull
        wrench = self._wrench(link, start, end)
        driver = self._feed.newest.get("DRIVER_STATUS")
        lockstep = driver is not None and bool(driver["lockstep"])
        self._requests.push(self._arm.link_name(link), wrench, LOCKSTEP_S if lockstep else PUSH_S)

    def _wrench(self, link: str, start: np.ndarray, end: np.ndarray) -> np.ndarray:
        """At the origin of the link, or of the tip, which the last link stands for."""
        force = float(self._stiffness.value) * (end - start)
        size = float(np.linalg.norm(force))
        limit = float(self._strongest.value)
        if size > limit:
            force *= limit / size
        lever = start - self._arm.origin(link)
        return np.concatenate([force, np.cross(lever, force)])
