"""Arms drawn from their URDF."""

import numpy as np
import pytest
import trimesh

from limber.model.robot import load_robot, load_urdf
from limber.monitor.arm_view import ArmView
from limber.monitor.scene import camera
from limber.monitor.shapes import LIMB, figure
from limber.paths import robot_names


def drawn_frames(view: ArmView) -> np.ndarray:
    """The tip as the nodes of the scene have it, 4x4."""
    X = np.eye(4)
    for link in view.figure.links:
        frame, step = view.frames[link], np.eye(4)
        step[:3, :3] = trimesh.transformations.quaternion_matrix(frame.wxyz)[:3, :3]
        step[:3, 3] = frame.position
        X = X @ step
    return X @ view.figure.X_tip


@pytest.mark.parametrize("name", robot_names())
def test_the_drawn_tip_is_where_the_arm_has_it(served, name):
    robot = load_robot(name)
    view = ArmView(served.scene, "/arm", figure(robot))
    rng = np.random.default_rng(3)
    for q in (robot.home, rng.uniform(-1.0, 1.0, len(robot.joints))):
        view.set(q)
        assert np.allclose(drawn_frames(view), robot.chain.forward(q), atol=1e-9)
    before = drawn_frames(view)
    view.set(np.full(len(robot.joints), np.nan))
    assert np.array_equal(drawn_frames(view), before), "NaN moves nothing"


@pytest.mark.parametrize("name", robot_names())
def test_every_arm_has_a_body_and_is_in_the_picture(name):
    robot = load_robot(name)
    made = figure(robot)
    assert made.troubles == []
    assert {shape.link for shape in made.shapes} >= set(made.links[1:])
    for shape in made.shapes:
        assert np.isfinite(shape.mesh.vertices).all() and len(shape.mesh.faces) < 5000
    eye = camera(robot, made)
    assert np.isclose(np.linalg.norm(eye.up), 1.0)
    distance = np.linalg.norm(eye.position - eye.look_at)
    assert made.reach_m < distance < 6.0 * max(made.reach_m, 0.3)
    if np.linalg.norm(robot.gravity) > 0:
        assert eye.up @ robot.gravity < 0


def write_arm(folder, visual: str):
    (folder / "robot.urdf").write_text(
        f"""<robot name="a">
          <material name="red"><color rgba="1 0 0 1"/></material>
          <link name="base"/>
          <joint name="j" type="revolute"><parent link="base"/><child link="arm"/>
            <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
          <link name="arm"><inertial><mass value="1"/>
            <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>{visual}</link>
          <joint name="f" type="fixed"><parent link="arm"/><child link="tip"/>
            <origin xyz="0.5 0 0"/></joint>
          <link name="tip"/></robot>""",
        encoding="utf-8",
    )
    return load_urdf(folder / "robot.urdf", "base", "tip")


def test_visuals_of_the_urdf_are_drawn_in_their_place_and_color(tmp_path):
    box = """<visual><origin xyz="0.25 0 0" rpy="0 0 1.5707963267948966"/>
      <geometry><box size="0.1 0.4 0.2"/></geometry><material name="red"/></visual>"""
    made = figure(write_arm(tmp_path, box))
    (shape,) = [shape for shape in made.shapes if shape.link == "arm"]
    assert np.allclose(shape.mesh.bounds, [[0.05, -0.05, -0.1], [0.45, 0.05, 0.1]])
    assert shape.color == (255, 0, 0)


def test_meshes_are_found_beside_the_urdf(tmp_path):
    (tmp_path / "meshes").mkdir()
    trimesh.creation.box([1.0, 1.0, 1.0]).export(tmp_path / "meshes" / "arm.stl")
    mesh = """<visual><geometry><mesh filename="package://some_arm/meshes/arm.stl"
      scale="0.1 0.2 0.3"/></geometry></visual>"""
    made = figure(write_arm(tmp_path, mesh))
    (shape,) = [shape for shape in made.shapes if shape.link == "arm"]
    assert np.allclose(shape.mesh.extents, [0.1, 0.2, 0.3])
    assert shape.color == LIMB and made.troubles == []


def test_a_mesh_that_is_missing_is_told_and_a_limb_drawn_instead(tmp_path):
    mesh = '<visual><geometry><mesh filename="package://p/none.stl"/></geometry></visual>'
    made = figure(write_arm(tmp_path, mesh))
    assert any(shape.link == "arm" for shape in made.shapes)
    assert "none.stl" in made.troubles[0] and "arm" in made.troubles[0]
