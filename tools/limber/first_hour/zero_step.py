"""Are the angles where the arm is? Drives off; the person compares the arm with its picture."""

import time

import numpy as np
from rich.console import Console

from limber.arrays import Floats
from limber.first_hour.person import answer
from limber.first_hour.record import PASSED, Found, failed
from limber.joint_check.drives import DriverOptions, drives
from limber.model.robot import Robot
from limber.plot.stick_figure import View, arm_points, draw

PERIOD_S = 0.02
WAIT_S = 30.0
MARGIN = 0.02  # rad or m beyond a joint's travel: a stop gives way
CURE = (
    "turn the arm to its pose at zero (all joints of the URDF at 0), then, for each joint that is "
    "wrong: limber motors zero BUS FAMILY:NUMBER; or change offset_rad or offset_m of that "
    "joint in robot.yaml by the difference"
)


def check(robot: Robot, console: Console) -> Found:
    with drives(robot, DriverOptions(), console) as found:
        end = time.monotonic() + WAIT_S
        while True:
            readings = found.read()
            if readings is not None and readings.fresh.all():
                break
            if time.monotonic() > end:
                silent = f"no reading of all joints within {WAIT_S:.0f} s: {found.awaited}"
                return failed(silent, "`limber motors scan BUS`", *found.news())
            time.sleep(PERIOD_S)
    return judge(robot, readings.theta, console)


def judge(robot: Robot, theta: Floats, console: Console) -> Found:
    lines = [
        f"{joint.name:16} {angle:+8.3f}   travel {joint.low:+.3f} to {joint.high:+.3f}"
        for joint, angle in zip(robot.joints, theta, strict=True)
    ]
    outside = [
        joint.name
        for joint, angle in zip(robot.joints, theta, strict=True)
        if not joint.low - MARGIN <= angle <= joint.high + MARGIN
    ]
    if outside:
        return failed(f"outside of their travel: {', '.join(outside)}", CURE, *lines)
    points = arm_points(robot, theta)
    tip = f"tip at ({', '.join(f'{x:.3f}' for x in points[-1])}) m in axes of {robot.base}"
    picture = draw(View.of(points, -_down(robot)), points, 48, 14)
    for line in (
        *lines,
        f"{tip}; seen from the side:",
        *picture,
    ):
        console.print(line, markup=False, highlight=False, soft_wrap=True)
    if answer(console, "Is the arm in this pose? Enter yes, n no, q quit", "n") == "n":
        return failed("the arm is in another pose than its readings", CURE, *lines)
    return Found(PASSED, (*lines, "the person beside the arm: in this pose"))


def _down(robot: Robot) -> Floats:
    weight = float(np.linalg.norm(robot.gravity))
    down: Floats = robot.gravity / weight if weight else np.array([0.0, 0.0, -1.0])
    return down
