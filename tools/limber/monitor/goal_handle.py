"""A gizmo at the goal: dragging it sends goals, else it stands where the controller's goal is."""

import time

import numpy as np
import viser

from limber.messages import constants
from limber.monitor.feed import Feed
from limber.monitor.laws import LawList
from limber.monitor.requests import Outcome, Requests

GOAL_S = 1 / 30
ARRIVED_M, ARRIVED = 0.002, 0.01  # the controller's goal has come to the gizmo
PATIENCE_S = 8.0  # longer than any motion by hand takes


class GoalHandle:
    def __init__(
        self, scene: viser.SceneApi, size_m: float, feed: Feed, laws: LawList, requests: Requests
    ) -> None:
        self._feed, self._laws, self._requests = feed, laws, requests
        self._dragged = False
        self._waiting = False  # a pose is not sent yet
        self._sent_s = -np.inf
        self._follows = True
        self.gizmo = scene.add_transform_controls(
            "/goal_handle", scale=size_m, line_width=3.0, depth_test=False, visible=False
        )

        @self.gizmo.on_drag_start
        async def _(_event: viser.TransformControlsEvent) -> None:
            self._dragged, self._follows = True, False

        @self.gizmo.on_update
        async def _(event: viser.TransformControlsEvent) -> None:
            if event.client is not None:
                self._waiting, self._follows = True, False

        @self.gizmo.on_drag_end
        async def _(_event: viser.TransformControlsEvent) -> None:
            self._dragged = False

    def draw(self, outcomes: list[Outcome]) -> None:
        """Called 30 times a second: what waits is sent, so that is the rate of the goals."""
        status, now = self._feed.newest.get("CONTROLLER_STATUS"), time.monotonic()
        if status is None:
            return
        law = self._laws.law(int(status["law"]))
        mode = constants("controller_status_t", "MODE_").get(int(status["mode"]))
        self.gizmo.visible = mode == "ACTIVE" and law is not None and law.goal != "none"
        if self._waiting and now - self._sent_s >= GOAL_S and self.gizmo.visible:
            self._send(now)
        refused = any(outcome.kind == "goal" and outcome.text for outcome in outcomes)
        if not self._follows and not self._dragged and not self._waiting:
            arrived = self._arrived(status) or now - self._sent_s > PATIENCE_S
            self._follows = arrived or refused or not self.gizmo.visible
        if self._follows and np.linalg.norm(status["quat_BD"]) > 0.5:
            self.gizmo.position, self.gizmo.wxyz = status["p_BD"], status["quat_BD"]

    def _send(self, now: float) -> None:
        p, quat = np.array(self.gizmo.position), np.array(self.gizmo.wxyz)
        self._waiting, self._sent_s = False, now
        length = float(np.linalg.norm(quat))
        if np.isfinite(p).all() and 0.5 < length < 2.0:  # a browser may send anything
            self._requests.goal(p, quat / length)

    def _arrived(self, status: np.void) -> bool:
        near = np.linalg.norm(status["p_BD"] - self.gizmo.position) < ARRIVED_M
        return bool(near and 1 - abs(float(status["quat_BD"] @ self.gizmo.wxyz)) < ARRIVED**2)
