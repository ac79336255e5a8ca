"""Giving the tip another inertia than it has."""

from limber.experiments.check import Check
from limber.experiments.context import Context

from . import reduced

TITLE = "Another inertia can be asked for, within limits that sampling and delay set"
CLAIM = "Feeding acceleration or contact force back lets a robot show an inertia different from its"
CLAIM += " own"
SECTION = "2"
PLANT = "mass of 2 kg, sampled at 1 kHz or in contact with delay"
FAST = True


def run(context: Context) -> list[Check]:
    checks = reduced.checks()
    with context.picture(TITLE, columns=2, size=(12.5, 5.0)) as (left, right):
        reduced.draw(left, right)
    return checks
