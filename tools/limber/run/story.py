"""What a scenario does to the arm, in words for somebody who has never heard of impedance."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from limber.measure import statics
from limber.model.scenario import Push, Scenario

AXES = ("x", "y", "z")
DITHER = (
    "One word changed: friction_compensation: dither. The motors swing a little, so that the gears "
    "no longer stick."
)
DITHER_OFF = "The dither is off again: on a wall it would hammer."


@dataclass(frozen=True)
class Line:
    time_s: float
    text: str


def story(scenario: Scenario) -> list[Line]:
    """In order of time."""
    lines = [Line(push.at_s, _push(scenario, push)) for push in scenario.pushes if not push.link]
    lines += [
        Line(push.at_s + push.duration_s, "The hand lets go: the spring brings the arm back.")
        for push in scenario.pushes
    ]
    lines += [
        Line(now.at_s, DITHER if now.dithered else DITHER_OFF)
        for before, now in pairwise(scenario.gains)
        if now.dithered != before.dithered
    ]
    for entry in scenario.timeline:
        text = _entry(scenario, entry)
        if text is not None:
            lines.append(Line(entry["at_s"], text))
    return sorted(lines, key=lambda line: line.time_s)


def until(lines: list[Line], time_s: float) -> list[Line]:
    """Those that have happened."""
    return [line for line in lines if line.time_s <= time_s]


def _entry(scenario: Scenario, entry: dict) -> str | None:
    if "mode" in entry:
        return {
            "hold": "The motors come on and hold the arm where it is.",
            "active": "The law takes over: from now on the arm is soft.",
            "stop": "The arm is stopped.",
        }.get(entry["mode"])
    if "K_x_translation_N_per_m" in entry.get("gains", ()):
        asked = np.diag(scenario.gains_at(entry["at_s"]).K_x)[:3]
        words = ", ".join(f"{K:g}" for K in (asked[:1] if np.ptp(asked) == 0 else asked))
        return f"Asked for: a spring of {words} N/m between the hand and its goal."
    if entry.get("wall"):
        return "A wall is put up in front of the hand."
    offset = np.array(entry.get("goal", {}).get("offset_m_rad", np.zeros(6)), float)[:3]
    if offset.any():
        ahead = bool(scenario.walls) and offset @ scenario.walls[0].normal < 0
        wall = " The wall is in its way: the spring presses the hand on it." if ahead else ""
        way, distance = _along(offset)
        return f"The goal moves {distance * 1e3:.0f} mm along {way}.{wall}"
    return None


def _push(scenario: Scenario, push: Push) -> str:
    force = push.wrench[:3]
    if not np.any(force):
        return f"A hand turns the tip with {np.linalg.norm(push.wrench[3:]):.3g} N m."
    way, newton = _along(force)
    text = f"A hand pushes with {newton:.3g} N along {way}."
    expected = _expected(scenario, push)
    if expected is None:
        return text
    stiffness, held = expected
    text += f" A spring of {stiffness:.0f} N/m gives way {newton / stiffness * 1e3:.0f} mm"
    if held <= 0.0:
        return text + "."
    return text + f"; joint friction can hold back up to {min(held, newton):.0f} N of the push."


def _expected(scenario: Scenario, push: Push) -> tuple[float, float] | None:
    """Stiffness along the push and the force that friction can hold, at the home pose."""
    robot, gains = scenario.robot, scenario.gains_at(push.at_s)
    J, X_BT = robot.chain.jacobian(robot.home), robot.chain.forward(robot.home)
    G = statics.tip_response(gains.law, J, gains.in_base(X_BT[:3, :3]), gains.K_q)
    if G is None:
        return None
    direction = np.concatenate([push.wrench[:3] / np.linalg.norm(push.wrench[:3]), np.zeros(3)])
    C = G @ J.T
    held = 0.0
    if scenario.friction and not gains.dithered:
        observed = gains.friction_observed
        friction = np.array([j.link_friction if observed else j.friction for j in robot.joints])
        held = statics.greatest_friction_force(G, C, direction, friction)
    return statics.stiffness_along(C, direction), held


def _along(vector: np.ndarray) -> tuple[str, float]:
    """Such as ("+x", 9.0)."""
    size = float(np.linalg.norm(vector))
    axis = int(np.argmax(np.abs(vector)))
    if abs(vector[axis]) > 0.999 * size:
        return "+-"[int(vector[axis] < 0)] + AXES[axis], size
    return "(" + " ".join(f"{part / size:+.2f}" for part in vector) + ")", size
