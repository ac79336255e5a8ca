"""Does the arm ring with the damping it was asked for?"""

from limber.experiments.check import Check
from limber.experiments.context import Context

from . import poses

TITLE = "Damping designed with the inertia gives every mode the ratio asked for"
CLAIM = "Damping can be chosen like stiffness: all knobs of the virtual spring, mass and damper"
SECTION = "2"
PLANT = "the controller's damping design at 30 poses of ideal7"
FAST = True


def run(context: Context) -> list[Check]:
    ratios = poses.damping_ratios(context)
    with context.picture(TITLE) as ax:
        poses.draw(ratios, ax)
    return poses.checks(ratios)
