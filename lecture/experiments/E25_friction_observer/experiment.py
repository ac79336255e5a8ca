"""Seeing friction at the motor, and taking it away."""

import math

import numpy as np

from limber_lecture.context import Comparison, Context, case, near_zero
from limber_lecture.pictures import BLACK, BLUE, GREEN, MEASURED, ORANGE, level, name_axes

from . import motor
from .motor import F_c, L, T

TITLE = "An observer sees friction after 1/L and takes its error away"
CLAIM = "Sensing the torque lets the arm get the torque it asks for: friction can be seen and added"
SECTION = "3.2"
PLANT = "motor of 0.2 kg m² with 2 N m of dry friction, 1 kHz"
FAST = True


def run(context: Context) -> list[Comparison]:
    friction, seen = step(context)
    start = int(np.argmax(friction > 0))
    after = start + round(1 / (L * T))
    with_it, without = motor.follow(compensated=True), motor.follow(compensated=False)
    (answer,) = observe(context, with_it.speed, with_it.tau_m)
    off = np.abs(answer - with_it.estimate).max()
    lag, seen_lag = F_c / motor.K * 1e3, without.lag[-1] * 1e3
    same = "the controller's observer and the one here differ by"
    checks = [
        Comparison("seen of a step after 1/L", 1 - math.exp(-1), seen[after] / F_c, "", 0.02),
        Comparison("seen in the end", F_c, seen[-1], "N m", 1e-3),
        Comparison("lag on a ramp without it", lag, seen_lag, "mrad", 0.01),
        near_zero("lag on a ramp with it", with_it.lag[-1] * 1e3, "mrad", 0.02),
        near_zero(same, off, "N m", 1e-9),
    ]
    draw(context, friction, seen, with_it, without)
    return checks


def observe(context: Context, speed: np.ndarray, tau_m: np.ndarray) -> list[np.ndarray]:
    """The controller's observer; no torque is transmitted to a link."""
    inputs = {"thetad": speed, "tau_m": tau_m, "tau": np.zeros(len(speed))}
    answers = context.eval([case("friction_seq", B=motor.B, L=L, T=T, **inputs)])
    return [np.ravel(answer["tau_f"]) for answer in answers]


def step(context: Context) -> tuple[np.ndarray, np.ndarray]:
    """Friction that sets in after 0.1 s, and what is seen of it."""
    friction = np.where(np.arange(round(0.6 / T)) < round(0.1 / T), 0.0, F_c)
    speed = motor.turning(friction)
    (seen,) = observe(context, speed, np.full(len(speed), 3.0))
    return friction, seen


def draw(context: Context, friction: np.ndarray, seen: np.ndarray, with_it, without) -> None:
    with context.picture(TITLE, columns=2, size=(12.5, 5.0)) as (left, right):
        t = np.arange(len(friction)) * T * 1e3 - 100
        left.plot(t, friction, color=BLACK, lw=1.2, label="friction torque")
        after = np.maximum(t, 0) * 1e-3
        left.plot(t, F_c * (1 - np.exp(-L * after)), color=BLUE, label="predicted: 1 - exp(-L t)")
        left.plot(t[::25], seen[::25], **MEASURED, color=BLUE, label="seen by the observer")
        level(left, "63 % after 1/L", (1e3 / L, 0.632 * F_c), (15, -15), upright=True)
        left.set_title("Friction sets in")
        name_axes(left, "time (ms)", "torque (N m)", "lower right")
        t = np.arange(len(without.lag)) * T
        right.plot(t, without.lag * 1e3, color=ORANGE, label="spring-damper law alone")
        right.plot(t, with_it.lag * 1e3, color=GREEN, label="with what the observer sees")
        lag = F_c / motor.K * 1e3
        right.axhline(lag, color=ORANGE, ls="--", lw=1.2, label="friction / stiffness")
        right.set_title("A slow ramp")
        name_axes(right, "time (s)", "lag behind the ramp (mrad)", "center right")
