"""Objects in a hand: with what force, how far they were lifted, whether they slipped."""

import numpy as np

from limber.log.reader import Log, time_s
from limber.measure.results import Result, close_to
from limber.measure.sound import sound
from limber.messages import message_class
from limber.model.scenario import Scenario

LIFTED_M = 2e-3  # lower, what it lies on still carries it
STATIC_S = 0.3  # before the fingers let go: the force no longer changes
TOLERANCE = 0.05  # friction in the hand adds to the motor's force, or takes from it


def grasp_results(log: Log, scenario: Scenario) -> list[Result]:
    names = [entry["name"] for entry in scenario.resolved["objects"]]
    if not names:
        return []
    truth, hand = sound(log.read("HAND_TRUTH")), sound(log.read("HAND_STATE"))
    results = []
    for i, name in enumerate(names):
        held = truth[truth["held"] == i]
        if not len(held) or not len(hand):
            results.append(Result(f"{name} grasped", False))
            continue
        results += _grasp(name, held, hand)
        slips = message_class("hand_truth_t").OBJECT_SLIPS
        up = -np.array(scenario.robot.gravity) / np.linalg.norm(scenario.robot.gravity)
        height = (truth["p_BO"][:, i] - truth["p_BO"][0, i]) @ up
        slipped = (truth["object_flags"][:, i] & slips != 0) & (height > LIFTED_M)
        note = "then it slipped" if slipped.any() else ""
        results.append(Result(f"{name} lifted by", float(height.max() * 1e3), "mm", note=note))
    return results


def _grasp(name: str, held: np.ndarray, hand: np.ndarray) -> list[Result]:
    """Of its last grasp, at its end: where the hand is to open, by whatever message."""
    t, state_t = time_s(held), time_s(hand)
    begin_s = t[np.flatnonzero(np.diff(t, prepend=-np.inf) > STATIC_S)[-1]]
    opening = (state_t > begin_s) & (hand["goal_width_m"] > hand["width_m"])
    end_s = min([t[-1], *state_t[opening]])
    window = (t >= end_s - STATIC_S) & (t < end_s)
    grasped = hand[(state_t > begin_s) & (state_t < end_s)]
    if not window.any() or not grasped["grasped"].any():
        return [Result(f"{name} grasped", False)]
    force_N, bound_N = held["force_N"][window].mean(), grasped["force_bound_N"][-1]
    result = close_to(
        f"{name} pressed with", float(force_N), "N", float(bound_N), TOLERANCE * float(bound_N)
    )
    result.span = (end_s - STATIC_S, end_s)
    return [result]
