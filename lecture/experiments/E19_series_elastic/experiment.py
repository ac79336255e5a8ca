"""A spring in the joint: what it filters, what it isolates, and what it costs."""

from limber_lecture.context import Comparison, Context

from . import baxter, passive, port, tip, tracking

TITLE = "A spring in the joint filters and spares, cannot be made stiff, and has to be led"
CLAIM = "A compliant element in the joint is a low-pass filter, isolates the joint from the motor,"
CLAIM += " and is safe without any control"
SECTION = "3.3"
PLANT = "one, two and seven joints with springs; ideal: reduced plants; bus: CiA 402 drives"
FAST = False


def run(context: Context) -> list[Comparison]:
    clamped = passive.checks(context)
    through, points = port.checks(context)
    followed = tracking.found(context)
    tips = tip.found(context)
    whole = baxter.checks(context)
    with context.picture(TITLE, 2, 2, size=(13.0, 10.0)) as axes:
        port.draw(points, axes[0, 0])
        tracking.draw(followed, axes[0, 1])
        tip.draw(tips, axes[1, 0])
        passive.draw(clamped, axes[1, 1])
    return [*clamped, *through, *tracking.checks(followed), *tip.checks(tips), *whole]
