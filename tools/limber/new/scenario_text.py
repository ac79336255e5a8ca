"""A first scenario: hold, joint impedance, one small push."""

from collections.abc import Iterator

import numpy as np

from limber.new.facts import ArmFacts, wall
from limber.new.guesses import Guesses, number, three

DEFLECTION_m = 0.02
TORQUE_SHARE = 0.2  # of each joint's torque, for the push
FREE_SHARE = 0.7  # of the way to the nearest soft wall
MOST_N = 200.0  # of a push in a scenario

TEXT = """\
# First steps of {name}, in simulation: the arm is held, gets soft at its joints, is pushed once at
# the tip and returns. `limber lab {file}` measures how far it gives way.
format: limber-scenario/1
name: {stem}
description: hold, joint impedance, one small push
robot: {folder}
mode: lockstep
duration_s: 9
seed: 1
friction: false # nobody has measured it
integrator: reference # for any inertia; the default, ode, is faster and wants those of real bodies
measure: {{stiffness: 0.1}} # relative tolerance

timeline:
  - {{at_s: 0.3, mode: hold}}
  - {{at_s: 0.5, gains: {{law: joint_pd, ramp_s: 0.2}}}} # K_q of robot.yaml
  - {{at_s: 0.8, mode: active}}
  # about {deflection:.2g} m, in the direction in which the tip gives way most
  - {{at_s: 2.0, push: {{force_N: [{force}], ramp_s: 0.5, for_s: 4}}}}
"""


def text(name: str, folder: str, file: str, arm: ArmFacts, guesses: Guesses) -> str:
    force, deflection = _push(arm, guesses)
    return TEXT.format(
        name=name,
        stem=file.removesuffix(".yaml"),
        folder=folder,
        file=file,
        deflection=deflection,
        force=", ".join(number(three(x)) for x in force),
    )


def _free(arm: ArmFacts, guesses: Guesses, torque: np.ndarray) -> float:
    """The force that takes no joint into its soft wall. `torque`: of one newton, by joint."""
    rooms = [
        min(home - joint.low, joint.high - home) - wall(joint.low, joint.high)
        for joint, home in zip(guesses.joints, arm.home, strict=True)
    ]
    forces: Iterator[float] = (
        FREE_SHARE * room * joint.K_q / max(abs(one), 1e-9)
        for joint, room, one in zip(guesses.joints, rooms, torque, strict=True)
    )
    return min(forces)


def _push(arm: ArmFacts, guesses: Guesses) -> tuple[np.ndarray, float]:
    """Force in base axes, and how far the tip moves: C = J K_q⁻¹ Jᵀ."""
    J = arm.jacobian[:3]
    C = (J / np.array([joint.K_q for joint in guesses.joints])) @ J.T
    compliance, axes = np.linalg.eigh(C)
    direction = np.where(np.abs(axes[:, -1]) < 1e-3, 0.0, axes[:, -1])
    direction /= np.linalg.norm(direction)
    bearable = min(
        TORQUE_SHARE * joint.torque / max(abs(torque), 1e-9)
        for joint, torque in zip(guesses.joints, J.T @ direction, strict=True)
    )
    force = min(
        DEFLECTION_m / compliance[-1], bearable, _free(arm, guesses, J.T @ direction), MOST_N
    )
    return force * direction, float(force * compliance[-1])
