"""The motion that identification needs, as a scenario for `limber run`, `lab` and `send`.

A tour of poses around home, there and back, so that every joint passes the same places in both
directions: slowly with a rest at each pose, then fast; at the end a creep to both sides of home,
where breakaway friction shows. Only joint goals, so the same file moves a real arm.
"""

from itertools import pairwise
from pathlib import Path

import numpy as np
import yaml

from limber.arrays import Floats
from limber.identify.arm import Arm
from limber.model.scenario import active_with
from limber.output import write_again

START_S = 1.5
SLOW_S, FAST_S, CREEP_S, REST_S = 3.0, 1.2, 5.0, 0.8
CREEP = 0.15  # rad or m
MARGIN = 0.05  # rad or m, from the ends of the joints
WAYPOINTS = 20  # between two poses


def poses(arm: Arm, spread: float, count: int, seed: int) -> Floats:
    """Within `spread` of home and the joints' limits; each joint from end to end of that range.

    Latin hypercube: every joint visits `count` different places (McKay, Beckman, Conover, 1979).
    """
    rng = np.random.default_rng(seed)
    low, high = within(arm, -spread), within(arm, spread)
    share = [rng.permutation(count) / (count - 1) for _ in arm.joints]
    return low + (high - low) * np.array(share).T


def within(arm: Arm, away: float) -> Floats:
    """Home and so much further, as far as the joints' limits permit."""
    limits = arm.robot.joints
    low, high = [j.low + MARGIN for j in limits], [j.high - MARGIN for j in limits]
    poses: Floats = np.clip(arm.robot.home + away, low, high)
    return poses


def timeline(arm: Arm, tour: Floats) -> tuple[list[dict], float]:
    """Entries and the time at which the last of them is over, s."""
    entries: list[dict] = [
        *active_with({"law": "joint_pd", "ramp_s": 0.2}),
    ]
    there_and_back = [*tour, *tour[-2::-1], arm.robot.home]
    creep = [within(arm, CREEP), within(arm, -CREEP), arm.robot.home]
    at = START_S
    for goals, moving_s, rest_s in (
        (there_and_back, SLOW_S, REST_S),
        (there_and_back, FAST_S, 0.1),
        (creep, CREEP_S, 0.1),
    ):
        for pose in goals:
            goal = {"joints_rad": [round(float(x), 4) for x in pose], "duration_s": moving_s}
            entries.append({"at_s": round(at, 3), "goal": goal})
            at += moving_s + rest_s
    return entries, at


def reach(arm: Arm, tour: Floats) -> tuple[Floats, Floats]:
    """Corners of the box, base axes, that the tip stays in between the poses, m."""
    stops = np.array([arm.robot.home, *tour, arm.robot.home])
    share = np.linspace(0.0, 1.0, WAYPOINTS)[:, None]
    ways = [start + share * (end - start) for start, end in pairwise(stops)]
    points = np.array([arm.robot.chain.forward(q)[:3, 3] for q in np.vstack(ways)])
    return points.min(axis=0), points.max(axis=0)


def scenario_text(arm: Arm, robot: str, spread: float, count: int, seed: int) -> str:
    tour = poses(arm, spread, count, seed)
    entries, end = timeline(arm, tour)
    head = {
        "format": "limber-scenario/1",
        "name": f"identify_{arm.robot.name}",
        "description": "a tour of poses, slow and fast, there and back, for limber identify",
        "robot": robot,
        "mode": "realtime",
        "duration_s": round(end + 0.5, 3),
        "seed": seed,
    }
    lines = [yaml.safe_dump(head, sort_keys=False), "timeline:\n"]
    for entry in entries:
        flow = yaml.safe_dump(entry, default_flow_style=True, sort_keys=False, width=10_000)
        lines.append(f"  - {flow}")
    return "".join(lines)


def write(arm: Arm, robot: str, spread: float, count: int, seed: int, out: Path) -> str:
    """Returns a summary for the user."""
    write_again(out, scenario_text(arm, robot, spread, count, seed))
    low, high = reach(arm, poses(arm, spread, count, seed))
    sides = zip("xyz", low, high, strict=True)
    box = ", ".join(f"{axis} {a:.2f} to {b:.2f}" for axis, a, b in sides)
    return f"wrote {out}: {count} poses within {spread:g} of home; the tip stays within {box} m"
