"""The 3D view: the arm as measured, its goal, forces, stiffness and walls."""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import viser

from limber.model import rotations
from limber.model.robot import Robot
from limber.monitor import ghost
from limber.monitor.arm_view import ArmView
from limber.monitor.feed import Batch, Feed
from limber.monitor.marks import (
    BELIEVED,
    PUSH,
    WALL_FORCE,
    ForceArrow,
    StiffnessEllipsoid,
    WallView,
)
from limber.monitor.shapes import Figure, figure
from limber.monitor.springs import Springs
from limber.monitor.walls import WallChange, wall_at

BACKGROUND = (236, 240, 245)
GROUND = (150, 150, 160)
GHOST_S = 0.1
AWAY = 1.75  # camera to arm, in reaches
GHOST = (46, 130, 220)


@dataclass(frozen=True)
class Camera:
    """Base frame, m; `up` is against gravity."""

    position: np.ndarray
    look_at: np.ndarray
    up: np.ndarray


def camera(robot: Robot, figure: Figure) -> Camera:
    """From the side and a little from the front, the arm at home in the middle."""
    weight = np.linalg.norm(robot.gravity)
    up = -robot.gravity / weight if weight > 0 else np.array([0.0, 0.0, 1.0])
    shoulder = figure.X_PF[0][:3, 3]
    hand = robot.chain.forward(robot.home)[:3, 3]
    ahead = hand - shoulder - ((hand - shoulder) @ up) * up
    if np.linalg.norm(ahead) < 0.1 * figure.reach_m:
        ahead = np.cross(up, [0.2, 1.0, 0.3])
    ahead /= np.linalg.norm(ahead)
    away = 0.45 * ahead - 0.85 * np.cross(up, ahead) + 0.35 * up
    middle = 0.5 * (shoulder + hand)
    far = AWAY * max(figure.reach_m, 0.3)
    return Camera(middle + far * away / np.linalg.norm(away), middle, up)


class Scene:
    """`uses_K_x` tells of a law's number whether it has a Cartesian stiffness to be shown; `walls`
    are a scenario's.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        robot: Robot,
        uses_K_x: Callable[[int], bool],
        walls: list[WallChange],
    ) -> None:
        scene = server.scene
        self._robot, self._walls = robot, walls
        self._sent_wall: tuple | None = None
        self._wall_sent = False
        self.figure = figure(robot)
        self._place_camera(server)
        self.arm = ArmView(scene, "/arm", self.figure)
        self._ghost = ArmView(scene, "/ghost", self.figure, ghost=GHOST)
        self._goal = scene.add_frame("/goal", axes_length=0.08, axes_radius=0.003, visible=False)
        self._push = ForceArrow(scene, "push", "push", PUSH)
        self._contact = ForceArrow(scene, "contact", "wall", WALL_FORCE)
        self._believed = ForceArrow(scene, "believed", "contact (controller)", BELIEVED)
        self._stiffness = StiffnessEllipsoid(scene)
        self._springs = Springs(scene, self.arm)
        self._wall = WallView(scene)
        self._law_uses_K_x: Callable[[int], bool] = uses_K_x
        self.seen = {"goal": True, "forces": True, "stiffness": True, "springs": True}
        self._ghost_s = -np.inf

    def _place_camera(self, server: viser.ViserServer) -> None:
        place = camera(self._robot, self.figure)
        server.scene.set_up_direction(place.up)
        # viser's picture of surroundings takes seconds without a graphics card
        server.scene.configure_environment_map(hdri=None)
        server.scene.add_light_hemisphere("/sky", ground_color=GROUND, intensity=2.0)
        server.scene.set_background_image(np.full((2, 2, 3), BACKGROUND, np.uint8))
        server.initial_camera.position = place.position
        server.initial_camera.look_at = place.look_at
        floor = rotations.from_z(place.up / np.linalg.norm(place.up))
        server.scene.add_grid("/floor", 4.0, 4.0, cell_size=0.1, section_size=0.5, wxyz=floor)

    def draw(self, feed: Feed, batch: Batch, old: bool) -> None:
        """`old`: the stack is silent; what is shown is greyed."""
        state, status = feed.newest.get("JOINT_STATE"), feed.newest.get("CONTROLLER_STATUS")
        truth = feed.newest.get("SIM_TRUTH") if feed.age_s("SIM_TRUTH") < 0.5 else None
        self.arm.set_grey(old)
        if state is not None:
            self.arm.set(state["q"][: int(state["num_joints"])])
            self._draw_springs(state)
        if status is not None and state is not None:
            self._draw_goal(state, status)
            self._draw_stiffness(status)
        self._draw_forces(status, truth)
        self._draw_wall(batch, state)

    def _draw_goal(self, state: np.void, status: np.void) -> None:
        tip = (status["p_BT"], status["quat_BT"])
        goal = (status["p_BD"], status["quat_BD"])
        seen = self.seen["goal"] and ghost.differs(*tip, *goal)
        if seen:
            self._goal.position, self._goal.wxyz = goal
        now = time.monotonic()
        if seen and now - self._ghost_s > GHOST_S:  # it takes more time than all the rest
            self._ghost_s = now
            q = state["q"][: int(state["num_joints"])]
            self._ghost.set(ghost.nearest_posture(self._robot.chain, q, *goal))
        self._ghost.show(seen)
        self._goal.visible = seen

    def _draw_stiffness(self, status: np.void) -> None:
        seen = self.seen["stiffness"] and self._law_uses_K_x(int(status["law"]))
        self._stiffness.set(status["K_x"] if seen else None, status["p_BD"])

    def _draw_springs(self, state: np.void) -> None:
        n = int(state["num_joints"])
        if self.seen["springs"]:
            self._springs.set((state["theta"] - state["q"])[:n], state["preload"][:n])
        else:
            self._springs.hide()

    def _draw_forces(self, status: np.void | None, truth: np.void | None) -> None:
        nothing = np.zeros(3)
        seen = self.seen["forces"]
        at = nothing if truth is None else truth["p_BT"]
        self._push.set(at, truth["F_push"][:3] if truth is not None and seen else nothing)
        self._contact.set(at, truth["F_contact"][:3] if truth is not None and seen else nothing)
        place = believed = nothing
        if status is not None:
            place, felt = status["p_BT"], bool(status["contact"]) and seen
            believed = status["F_ext"][:3] if felt else nothing
        self._believed.set(place, believed)

    def _draw_wall(self, batch: Batch, state: np.void | None) -> None:
        """The last one sent, else the scenario's."""
        for event in batch.read("SCENARIO_EVENT"):
            if int(event["kind"]) == 0:
                self._wall_sent = True
                stands = float(event["stiffness_N_per_m"]) > 0
                self._sent_wall = (event["point"], event["normal"]) if stands else None
        now_s = 0.0 if state is None else float(state["time_ns"]) * 1e-9
        wall = self._sent_wall if self._wall_sent else wall_at(self._walls, now_s)
        if wall is None:
            self._wall.hide()
        else:
            self._wall.set(*wall)
