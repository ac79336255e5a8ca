"""The springs of elastic joints in the scene: how far each is bent, and its preload."""

import numpy as np
import viser

from limber.arrays import Floats
from limber.model.urdf import Joint
from limber.monitor.arm_view import ArmView

LARGER = 20.0  # than life
LEAST = 5e-4  # rad or m: less is noise
MOST = 1.5 * np.pi  # of an arc, rad
RADIUS = 0.11  # over the arm's reach
POINTS = 24
COLOR = (220, 60, 160)


class Springs:
    """At each bent joint an arc about its axis, or a line along it, from the link to where the
    motor stands, 20 times as large as it is, with the deflection in words.
    """

    def __init__(self, scene: viser.SceneApi, arm: ArmView) -> None:
        self._joints = arm.figure.joints
        self._radius = RADIUS * arm.figure.reach_m
        nothing = np.zeros((POINTS, 2, 3), np.float32)
        names = [f"{arm.frames[joint.child].name}/spring" for joint in self._joints]
        self._lines = [
            scene.add_line_segments(
                name, nothing, COLOR, thickness=4.0, thickness_units="screen", visible=False
            )
            for name in names
        ]
        self._labels = [scene.add_label(f"{name}_label", "", visible=False) for name in names]

    def set(self, deflection: Floats, preload: Floats) -> None:
        """Motor less link, and preload, per joint; rad or m."""
        drawn = zip(self._joints, self._lines, self._labels, deflection, preload, strict=False)
        for joint, line, label, bent, tight in drawn:
            seen = bool(np.isfinite(bent) and abs(bent) > LEAST)
            if seen:
                path = arc(joint, float(bent), self._radius)
                line.points = np.stack([path[:-1], path[1:]], axis=1).astype(np.float32)
                label.position = path[-1]
                label.text = words(joint, float(bent), float(tight))
            line.visible = label.visible = seen

    def hide(self) -> None:
        self.set(np.zeros(len(self._joints)), np.zeros(len(self._joints)))


def arc(joint: Joint, bent: float, radius: float) -> Floats:
    """Points in the child link's frame, from the link to the motor."""
    axis = joint.axis
    beside = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    beside /= np.linalg.norm(beside)
    share = np.linspace(0.0, 1.0, POINTS + 1)[:, None]
    if joint.kind == "prismatic":
        return radius * beside + share * LARGER * bent * axis
    angle = share * np.clip(LARGER * bent, -MOST, MOST)
    bow: Floats = radius * (np.cos(angle) * beside + np.sin(angle) * np.cross(axis, beside))
    return bow


def words(joint: Joint, bent: float, preload: float) -> str:
    unit = "mm" if joint.kind == "prismatic" else "mrad"
    tight = f", preload {1e3 * preload:.0f} {unit}" if abs(preload) > LEAST else ""
    return f"spring {1e3 * bent:.1f} {unit}{tight}"
