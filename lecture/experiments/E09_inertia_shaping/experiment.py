"""Giving the tip another inertia than it has."""

from limber_lecture.context import Comparison, Context

from . import arm, reduced

TITLE = "Another inertia can be asked for, within limits that sampling and delay set"
CLAIM = "Feeding acceleration or contact force back lets a robot show an inertia different from its"
CLAIM += " own"
SECTION = "2"
PLANT = "planar2r with a force sensor at the tip; a mass of 2 kg for the limits"
FAST = False


def run(context: Context) -> list[Comparison]:
    modes, starts = arm.runs(context)
    with context.picture(TITLE, columns=3, size=(16.5, 5.0)) as (left, middle, right):
        arm.draw(starts, left)
        reduced.draw(middle, right)
    return [*arm.checks(modes, starts), *reduced.checks()]
