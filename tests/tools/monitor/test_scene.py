"""Marks in the scene."""

import numpy as np
from scipy.spatial.transform import Rotation

from limber.model.robot import load_robot
from limber.model.scenario import load_scenario
from limber.monitor import ghost
from limber.monitor.arm_view import ArmView
from limber.monitor.marks import ELLIPSOID_M, ForceArrow, StiffnessEllipsoid, WallView, ellipsoid
from limber.monitor.shapes import figure
from limber.monitor.springs import LARGER, Springs, arc
from limber.monitor.walls import wall_at, wall_changes


def test_the_ellipsoid_lies_along_the_eigenvectors():
    R = Rotation.from_rotvec([0.3, -0.5, 0.9]).as_matrix()
    axes, turned = ellipsoid(R @ np.diag([125.0, 500.0, 2000.0]) @ R.T)
    assert np.allclose(axes, ELLIPSOID_M * np.array([0.5, 1.0, 2.0]))
    assert np.allclose(np.abs(np.sum(turned * R, axis=0)), 1.0)
    assert np.isclose(np.linalg.det(turned), 1.0)


def test_an_ellipsoid_that_is_not_known_is_hidden(served):
    view = StiffnessEllipsoid(served.scene)
    ball = served.scene.get_handle_by_name("/stiffness")
    view.set(np.eye(6) * 400, np.zeros(3))
    assert ball.visible
    for unknown in (None, np.zeros((6, 6)), np.full((6, 6), np.nan)):
        view.set(unknown, np.zeros(3))
        assert not ball.visible


def test_an_arrow_is_as_long_as_its_force_up_to_a_length(served):
    arrow = ForceArrow(served.scene, "push", "push", (0, 0, 255))
    drawn = served.scene.get_handle_by_name("/forces/push")
    label = served.scene.get_handle_by_name("/forces/push_label")

    def length() -> float:
        return float(np.linalg.norm(drawn.points[0, 1] - drawn.points[0, 0]))

    arrow.set(np.zeros(3), np.array([0.0, 10.0, 0.0]))
    short = length()
    arrow.set(np.zeros(3), np.array([0.0, 20.0, 0.0]))
    assert np.isclose(length(), 2 * short)
    arrow.set(np.zeros(3), np.array([0.0, 5000.0, 0.0]))
    assert np.isclose(length(), 0.6) and label.text == "push 5000.0 N"
    for nothing in (np.zeros(3), np.full(3, np.nan)):
        arrow.set(np.zeros(3), nothing)
        assert not drawn.visible and not label.visible


def test_the_ghost_stands_with_its_tip_at_the_goal():
    robot = load_robot("panda")
    goal = robot.chain.forward(robot.home + 0.15)
    quat = Rotation.from_matrix(goal[:3, :3]).as_quat(scalar_first=True)
    q = ghost.nearest_posture(robot.chain, robot.home, goal[:3, 3], quat)
    assert np.allclose(robot.chain.forward(q), goal, atol=5e-3)
    assert ghost.differs(np.zeros(3), quat, np.array([0.0, 0.0, 0.01]), quat)
    assert not ghost.differs(np.zeros(3), quat, np.zeros(3), -quat), "the same rotation"
    assert not ghost.differs(np.full(3, np.nan), quat, np.zeros(3), quat)


def test_the_wall_of_a_scenario_at_a_time(tmp_path, served):
    path = tmp_path / "scenario.yaml"
    path.write_text(
        """{format: limber-scenario/1, robot: openarm, duration_s: 4, timeline: [
          {at_s: 3, wall: "off"},
          {at_s: 1, wall: {point_m: [1, 0, 0], normal: [-1, 0, 0], stiffness_N_per_m: 1000}},
          {at_s: 2, mode: hold}]}""",
        encoding="utf-8",
    )
    changes = wall_changes(load_scenario(path))
    assert wall_at(changes, 0.5) is None
    point, normal = wall_at(changes, 2.5)
    assert wall_at(changes, 3.5) is None
    view = WallView(served.scene)
    view.set(point, 2.0 * normal)
    plate = served.scene.get_handle_by_name("/wall")
    assert plate.visible
    facing = Rotation.from_quat(plate.wxyz, scalar_first=True).apply([0.0, 0.0, 1.0])
    assert np.allclose(facing, normal)
    view.set(np.full(3, np.nan), normal)
    assert np.isfinite(plate.position).all()


def test_the_arc_of_a_spring_is_the_deflection_larger(served):
    robot = load_robot("antagonist2r")
    joint = figure(robot).joints[0]
    path = arc(joint, -0.02, 0.1)
    assert np.allclose(path @ joint.axis, 0.0)
    assert np.allclose(np.linalg.norm(path, axis=1), 0.1)
    turned = np.arctan2(np.cross(path[0], path[-1]) @ joint.axis, path[0] @ path[-1])
    assert np.isclose(turned, -0.02 * LARGER)


def test_springs_are_seen_where_they_are_bent(served):
    robot = load_robot("antagonist2r")
    arm = ArmView(served.scene, "/arm", figure(robot))
    springs = Springs(served.scene, arm)
    names = [f"{arm.frames[joint.child].name}/spring" for joint in arm.figure.joints]
    lines = [served.scene.get_handle_by_name(name) for name in names]
    springs.set(np.array([0.02, np.nan]), np.array([0.3, 0.0]))
    assert [line.visible for line in lines] == [True, False]
    label = served.scene.get_handle_by_name(f"{names[0]}_label")
    assert label.text == "spring 20.0 mrad, preload 300 mrad"
    springs.hide()
    assert not any(line.visible for line in lines)


def test_names_of_links_are_no_paths(served):
    """A link may be called anything that XML can hold."""
    made = figure(load_robot("planar2r"))
    evil = ["a/b", "<script>alert(1)</script>"]
    for joint, name in zip(made.joints, evil, strict=False):
        object.__setattr__(joint, "child", name)
    made.shapes = []
    view = ArmView(served.scene, "/evil", made)
    names = [frame.name for frame in view.frames.values()]
    assert names == ["/evil", "/evil/1", "/evil/1/2"]
