"""An arm in the scene: one node a link, each in the one before: a pose is one turn a joint."""

import numpy as np
import viser

from limber.model.rotations import matrix_of, product, quaternion_of
from limber.monitor.shapes import Figure, Shape

THINNER = 0.94


class ArmView:
    """`ghost`: of one colour, translucent, without the base, and thinner, so that it is hidden
    where it lies in the arm.
    """

    def __init__(
        self, scene: viser.SceneApi, root: str, figure: Figure, ghost: tuple | None = None
    ) -> None:
        self.figure = figure
        self._quats = np.array([quaternion_of(X[:3, :3]) for X in figure.X_PF]).reshape(-1, 4)
        self.frames = {figure.base: scene.add_frame(root, show_axes=False)}
        path = root
        for joint in figure.joints:
            path = f"{path}/{len(self.frames)}"  # a link's name may be anything
            X = figure.X_PF[len(self.frames) - 1]
            self.frames[joint.child] = scene.add_frame(
                path, show_axes=False, position=X[:3, 3], wxyz=quaternion_of(X[:3, :3])
            )
        self.meshes: list[tuple[Shape, viser.MeshHandle]] = [
            (shape, self._mesh(scene, f"{self.frames[shape.link].name}/shape{i}", shape, ghost))
            for i, shape in enumerate(figure.shapes)
            if ghost is None or shape.link != figure.base
        ]
        self._grey = False
        self.set(np.zeros(len(figure.joints)))

    def _mesh(
        self, scene: viser.SceneApi, name: str, shape: Shape, ghost: tuple | None
    ) -> viser.MeshHandle:
        vertices, middle = shape.mesh.vertices, shape.mesh.bounds.mean(axis=0)
        if ghost is not None:
            vertices = middle + THINNER * (vertices - middle)
        return scene.add_mesh_simple(
            name,
            np.asarray(vertices, np.float32),
            np.asarray(shape.mesh.faces, np.uint32),
            color=shape.color if ghost is None else ghost,
            opacity=None if ghost is None else 0.28,
            cast_shadow=ghost is None,
            receive_shadow=ghost is None,
        )

    def set(self, q: np.ndarray) -> None:
        """Joint positions, rad or m; those that are not finite stay as they were."""
        for i, (joint, value) in enumerate(zip(self.figure.joints, q, strict=False)):
            if not np.isfinite(value):
                continue
            frame, X = self.frames[joint.child], self.figure.X_PF[i]
            if joint.kind == "prismatic":
                frame.position = X[:3, 3] + X[:3, :3] @ joint.axis * value
            else:
                turn = np.array([np.cos(0.5 * value), *(np.sin(0.5 * value) * joint.axis)])
                frame.wxyz = product(self._quats[i], turn)

    def origin(self, link: str) -> np.ndarray:
        """Where a push on the link acts: its origin, of the last link the tip's; base frame, m."""
        X = np.eye(4)
        for name in self.figure.links[: self.figure.links.index(link) + 1]:
            step, frame = np.eye(4), self.frames[name]
            step[:3, :3] = matrix_of(frame.wxyz)
            step[:3, 3] = frame.position
            X = X @ step
        return (X @ self.figure.X_tip if link == self.figure.links[-1] else X)[:3, 3]

    def link_name(self, link: str) -> str:
        """As a push names it: the last link is the tip."""
        return "" if link == self.figure.links[-1] else link

    def show(self, visible: bool) -> None:
        self.frames[self.figure.base].visible = visible

    def set_grey(self, grey: bool) -> None:
        """Grey: what is shown is old."""
        if grey == self._grey:
            return
        self._grey = grey
        for shape, handle in self.meshes:
            handle.color = (150, 150, 150) if grey else shape.color
