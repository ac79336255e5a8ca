"""Forces, stiffness, goal and wall in the scene. All in base axes, m and N."""

import numpy as np
import viser

from limber.model.rotations import from_z, quaternion_of

M_PER_N = 0.012
LONGEST_M = 0.6
LEAST_N = 0.3
ELLIPSOID_M = 0.10  # semi-axis at REFERENCE_N_PER_M
REFERENCE_N_PER_M = 500.0
WALL_M = 0.4
PUSH, WALL_FORCE, BELIEVED = (31, 119, 220), (214, 62, 62), (240, 140, 45)


class ForceArrow:
    """An arrow that begins where the force acts, with its size in words. Longer than `LONGEST_M`
    it is cut; the words tell the whole.
    """

    def __init__(self, scene: viser.SceneApi, name: str, what: str, color: tuple) -> None:
        self._what = what
        points = np.zeros((1, 2, 3), np.float32)
        self._arrow = scene.add_arrows(
            f"/forces/{name}",
            points,
            color,
            shaft_radius=0.006,
            head_radius=0.016,
            head_length=0.035,
            visible=False,
        )
        self._label = scene.add_label(f"/forces/{name}_label", "", visible=False)

    def set(self, at: np.ndarray, force: np.ndarray) -> None:
        size = float(np.linalg.norm(force))
        seen = bool(np.isfinite(at).all() and LEAST_N < size < np.inf)
        if seen:
            tip = at + force / size * min(size * M_PER_N, LONGEST_M)
            self._arrow.points = np.array([[at, tip]], np.float32)
            self._label.position = tip
            self._label.text = f"{self._what} {size:.1f} N"
        self._arrow.visible = self._label.visible = seen


class StiffnessEllipsoid:
    """Of the translation: its axes are the eigenvectors, their length grows with the square root
    of the stiffness.
    """

    def __init__(self, scene: viser.SceneApi) -> None:
        self._ball = scene.add_icosphere(
            "/stiffness",
            radius=1.0,
            color=(46, 160, 110),
            opacity=0.22,
            cast_shadow=False,
            receive_shadow=False,
            visible=False,
        )

    def set(self, K_x: np.ndarray | None, center: np.ndarray) -> None:
        """`K_x`: 6x6, N/m first; None hides it."""
        usable = K_x is not None and bool(np.isfinite(K_x).all())
        K = np.asarray(K_x if usable else np.zeros((6, 6)), float)[:3, :3]
        self._ball.visible = usable and bool(np.abs(K).max() > 0)
        if not self._ball.visible or not np.isfinite(center).all():
            return
        axes, R = ellipsoid(K)
        x, y, z = (float(a) for a in axes)
        self._ball.scale = x, y, z
        self._ball.wxyz = quaternion_of(R)
        self._ball.position = center


def ellipsoid(K: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Semi-axes, m, and the rotation whose columns they lie along."""
    values, R = np.linalg.eigh(0.5 * (K + K.T))
    if np.linalg.det(R) < 0:
        R[:, 0] = -R[:, 0]
    axes = ELLIPSOID_M * np.sqrt(np.maximum(values, 0.0) / REFERENCE_N_PER_M)
    return np.maximum(axes, 1e-3), R


class WallView:
    def __init__(self, scene: viser.SceneApi) -> None:
        self._plate = scene.add_box(
            "/wall",
            dimensions=(WALL_M, WALL_M, 0.006),
            color=(120, 130, 145),
            opacity=0.55,
            cast_shadow=False,
            visible=False,
        )

    def set(self, point: np.ndarray, normal: np.ndarray) -> None:
        """`normal` points to the free side; the plate's surface goes through `point`."""
        length = float(np.linalg.norm(normal))
        if not (np.isfinite(point).all() and 0 < length < np.inf):
            return
        n = normal / length
        self._plate.position = point - 0.003 * n
        self._plate.wxyz = from_z(n)
        self._plate.visible = True

    def hide(self) -> None:
        self._plate.visible = False
