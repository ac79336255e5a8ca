"""The arm itself under a force that grows slowly along the deviation: where its elbow snaps."""

from dataclasses import dataclass

import numpy as np

from limber_lecture import planar2r as arm
from limber_lecture.context import Comparison, Context, at_most
from limber_lecture.pictures import Axes, level, name_axes, note
from limber_lecture.timeline import tip_gains
from limber_lecture.truth import RAMP, joints, motion, status

from .equilibria import closed_curve
from .laws import ALONG, COLOR, DIRECT, P_D, Q_D, Form, K, name

# The load grows to a share of the limit, then slowly past it: an arm takes its time to leave the
# place where it could just rest
START_S, SLOW_S, LONG_S = 2.0, 6.0, 30.0
SHARES = (0.85, 1.15)
# Once it snaps it swings as fast as its limits let it.
SWINGS = RAMP | {"VELOCITY", "POSITION"}
SNAPS: Form = ("full", "current")


@dataclass(frozen=True)
class Pushed:
    """While the load grows; deviation along it in m, load in N, angle of the elbow in rad."""

    deviation: np.ndarray
    load: np.ndarray
    elbow: np.ndarray

    @property
    def snapped_at(self) -> float:
        """Load when the arm is stretched, on its way to the other elbow; NaN if it never is."""
        beyond = np.flatnonzero(self.elbow < 0.0)
        return float(self.load[beyond[0]]) if len(beyond) else float("nan")


def pushed(context: Context, form: Form, limit_N: float) -> Pushed:
    gains = tip_gains([*np.diag(K), 0.0], damping_ratio=0.3)
    if form != DIRECT:
        terms, pose = form
        gains |= {"law": "mapped_joint_impedance", "stiffness_terms": terms, "stiffness_pose": pose}
    first, second = ({"id": 1, "force_N": [*(share * limit_N * ALONG), 0.0]} for share in SHARES)
    entries = [
        {"at_s": START_S, "push": {**first, "ramp_s": SLOW_S - START_S, "for_s": 60.0}},
        {"at_s": SLOW_S, "push": {**second, "ramp_s": LONG_S, "for_s": 60.0}},
    ]
    end = SLOW_S + LONG_S
    name = f"push_{'direct' if form == DIRECT else '_'.join(form)}"
    log = context.run_law(name, arm.ROBOT, gains, entries, end, start_q=Q_D)
    status(log, START_S, end, SWINGS)
    rows = motion(log, START_S, end)
    along = (rows["p_BT"][:, :2] - P_D) @ ALONG
    return Pushed(along, rows["F_push"][:, :2] @ ALONG, joints(rows)[:, 1])


def limit() -> float:
    """Greatest load under which there is a rest, N."""
    return float(closed_curve(SNAPS, 0.15)[:, 1].max())


def runs(context: Context) -> dict[Form, Pushed]:
    return {form: pushed(context, form, limit()) for form in (SNAPS, DIRECT)}


def checks(found: dict[Form, Pushed]) -> list[Comparison]:
    snapping, direct = found[SNAPS], found[DIRECT]
    stays = direct.load[-1] / K[0, 0], direct.deviation[-1]
    return [
        Comparison("the arm snaps to the other elbow at", limit(), snapping.snapped_at, "N", 0.05),
        at_most("elbow afterwards", 0.0, snapping.elbow[-1], "rad"),
        Comparison("direct law, deviation under 1.15 of that", *stays, "m", 0.01),
    ]


def draw(found: dict[Form, Pushed], ax: Axes) -> None:
    """The elbow's angle over the load; the arm's motion is what is measured."""
    for form, run in found.items():
        ax.plot(run.load, np.degrees(run.elbow), color=COLOR[form], label=f"{name(form)}, the arm")
    bound = "predicted:\nbeyond this it\ncannot rest"
    level(ax, bound, (limit(), 20), (-8, 0), upright=True, ha="right")
    ax.axhline(0, color="0.5", lw=0.8)
    note(ax, "stretched", (0.3, 2))
    ax.set_title("The arm itself, pushed harder and harder")
    name_axes(ax, "load (N)", "angle of the elbow (°)", "lower left")
