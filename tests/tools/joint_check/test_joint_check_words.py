"""The words for a direction, against kinematics by hand."""

import shutil

import numpy as np
import pytest

from limber.joint_check.words import amount_words, direction_words, motion_words, slides
from limber.model.robot import Robot, load_robot
from limber.paths import ROOT

UP = np.array([0.0, 0.0, -9.81])


def told(robot: Robot, joint: str, q: list[float], change: float = 0.2) -> str:
    return motion_words(robot, robot.joint_names.index(joint), np.array(q), change)


def test_planar_arm_stretched_along_x():
    """Both axes point along +z, rods of 0.5 and 0.4 m, gravity along -y: the tip, 0.9 m from the
    shoulder and 0.4 m from the elbow, moves by twice the radius times sin(0.1).
    """
    robot = load_robot("planar2r")
    assert 2 * 0.9 * np.sin(0.1) == pytest.approx(0.18, abs=0.005)
    assert told(robot, "shoulder", [0, 0]) == (
        "by 0.2 rad (11°) counter-clockwise, seen with its axis, which points along +z, towards "
        "you: the tip moves up (+y), 18 cm"
    )
    assert told(robot, "elbow", [0, 0], -0.2).startswith("by 0.2 rad (11°) clockwise")
    assert told(robot, "elbow", [0, 0], -0.2).endswith("the tip moves down (-y), 8 cm")


def test_planar_arm_upright():
    """Shoulder at 90 degrees: the tip is above it and moves along -x; with the elbow at 90 degrees
    besides, the fore-arm lies along -x and its end moves down.
    """
    robot = load_robot("planar2r")
    assert told(robot, "shoulder", [np.pi / 2, 0]).endswith("the tip moves along -x, 18 cm")
    assert told(robot, "elbow", [np.pi / 2, np.pi / 2]).endswith("the tip moves down (-y), 8 cm")


def test_openarm_hanging_down():
    """At zero it hangs: axis 1 points to -y at 0.698 m, the tip is at 0.262 m, 0.436 m below it, so
    that it swings forwards by 0.2 * 0.436 = 0.087 m; axis 2 points to -x, and it swings to -y.
    """
    robot, zero = load_robot("openarm"), [0.0] * 7
    assert told(robot, "joint1", zero).endswith(
        "its axis, which points right (-y), towards you: the tip moves forward (+x), 9 cm"
    )
    assert told(robot, "joint2", zero).endswith(
        "which points back (-x), towards you: the tip moves right (-y), 9 cm"
    )
    assert told(robot, "joint4", zero).endswith("the tip moves forward (+x), 4 cm")


def test_where_the_tip_stays_its_side_turns():
    """Axis 3 of the hanging arm points down through the tip: by the right hand, +x turns to -y.
    Axis 6 points forward through it: +y, where -y turned to -z, turns to +z.
    """
    robot, zero = load_robot("openarm"), [0.0] * 7
    assert told(robot, "joint3", zero).endswith(
        "the tip stays where it is; its x axis, which points forward (+x), turns towards right (-y)"
    )
    assert told(robot, "joint6", zero).endswith("points right (-y), turns towards down (-z)")


def test_where_the_tip_hardly_moves_its_link_does():
    """Axis 7 points to -y, the tip is on it; link 7 hangs 0.07 m below."""
    assert told(load_robot("openarm"), "joint7", [0.0] * 7).endswith(
        "the tip hardly moves, link7 moves forward (+x), 14 mm"
    )


def test_a_slide(tmp_path):
    """joint `slide` along x of a link that `turn` has turned by 90 degrees, from base to hand."""
    robot = slide_arm(tmp_path)
    assert slides(robot) == [False, True, False]
    assert told(robot, "slide", [np.pi / 2, 0.1, 0.0], 0.02) == (
        "by 20 mm along its axis, which points left (+y): the tip moves left (+y), 20 mm"
    )
    assert told(robot, "slide", [np.pi / 2, 0.1, 0.0], -0.02) == (
        "by 20 mm against its axis, which points left (+y): the tip moves right (-y), 20 mm"
    )


def slide_arm(folder) -> Robot:
    shutil.copytree(ROOT / "tests/robots/data/arm", folder, dirs_exist_ok=True)
    return load_robot(str(folder))


def test_directions():
    assert direction_words(np.array([0.3, 0, 0.5]), UP) == "up (+z) and forward (+x)"
    assert direction_words(np.array([0.01, -0.5, 0.1]), UP) == "right (-y)"
    assert direction_words(np.array([-1.0, 0, 0]), UP) == "back (-x)"
    assert direction_words(np.array([0, 0, -1.0]), UP) == "down (-z)"


@pytest.mark.parametrize(
    ("gravity", "words"),
    [
        ([0, 0, 9.81], "down (+z)"),  # hangs from the ceiling
        ([-9.81, 0, 0], "along +z"),  # on a wall
        ([0, 0, 0], "along +z"),
        ([0, -7, -7], "along +z"),  # tilted: nothing is up
    ],
)
def test_up_is_where_gravity_does_not_point(gravity, words):
    assert direction_words(np.array([0, 0, 1.0]), np.array(gravity, float)) == words


def test_amounts():
    assert amount_words(-0.2, False) == "0.2 rad (11°)"
    assert amount_words(-0.0213, True) == "21 mm"
