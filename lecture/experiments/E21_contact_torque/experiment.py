"""A contact that is not at the tip: who notices?"""

import numpy as np

from limber_lecture.context import Comparison, Context, near_zero
from limber_lecture.pictures import BLUE, MEASURED, ORANGE, Axes

from .runs import PUSHES, SOURCES, Rest, predicted, runs

TITLE = "A force sensor at the tip does not notice a push on link 1; the joints' torques do"
CLAIM = "The contact torque can come from the force at the tip or from joint torque sensors"
SECTION = "3"
PLANT = "planar2r with a force sensor at the tip, exact equations"
FAST = True


def run(context: Context) -> list[Comparison]:
    rests = runs(context)
    with context.picture(TITLE, columns=2, size=(12.0, 5.0)) as axes:
        for where, ax in zip(PUSHES, axes, strict=True):
            draw([rest for rest in rests if rest.where == where], ax)
    checks = []
    for rest in rests:
        asked = predicted(rest.where, rest.source)
        for i, joint in enumerate(("shoulder", "elbow")):
            name = f"push on {rest.where}, {SOURCES[rest.source]}: {joint} gives way by"
            if asked[i] == 0.0:
                checks.append(near_zero(name, rest.moved[i], "rad", 0.01 * abs(asked).max()))
            else:
                checks.append(Comparison(name, asked[i], rest.moved[i], "rad", 0.01))
    return checks


def draw(rests: list[Rest], ax: Axes) -> None:
    places = np.arange(2)
    for rest, color, side in zip(rests, (BLUE, ORANGE), (-0.2, 0.2), strict=True):
        asked = np.degrees(predicted(rest.where, rest.source))
        label = f"contact from the {SOURCES[rest.source]}"
        ax.bar(places + side, asked, 0.36, color=color, alpha=0.45, label=label)
        ax.plot(places + side, np.degrees(rest.moved), **MEASURED, color=color)
    ax.plot([], [], **MEASURED, color="0.3", label="measured; bar: predicted")
    ax.axhline(0, color="0.5", lw=0.8)
    ax.set_xticks(places, ["shoulder", "elbow"])
    ax.set_title(f"Push on {rests[0].where}")
    ax.set_ylabel("joint gives way by (°)")
    ax.legend()
