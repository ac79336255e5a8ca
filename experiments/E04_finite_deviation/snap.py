"""The arm itself under a force that grows slowly along the deviation: where its elbow snaps."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from limber.experiments import planar2r as arm
from limber.experiments.check import Check
from limber.experiments.context import Context
from limber.experiments.pictures import BLACK, ORANGE
from limber.experiments.truth import joints, motion, status

from .equilibria import closed_curve
from .laws import ALONG, DIRECT, P_D, Q_D, Form, K, name

# The load grows to a share of the limit, then slowly past it: an arm takes its time to leave the
# place where it could just rest
START_S, SLOW_S, LONG_S = 2.0, 6.0, 30.0
SHARES = (0.85, 1.15)
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
    law = {"law": "cartesian_impedance"}
    if form != DIRECT:
        law = {"law": "eq7", "stiffness_terms": form[0], "stiffness_pose": form[1]}
    gains = {
        **law,
        "K_x_translation_N_per_m": [*np.diag(K).tolist(), 0.0],
        "K_x_rotation_Nm_per_rad": 0.0,
        "damping_ratio": 0.3,
    }
    first, second = (
        {"id": 1, "force_N": [*(share * limit_N * ALONG).tolist(), 0.0]} for share in SHARES
    )
    end = SLOW_S + LONG_S
    scenario = {
        "robot": arm.ROBOT,
        "integrator": "reference",
        "start_q": Q_D.tolist(),
        "duration_s": end + 0.1,
        "timeline": [
            {"at_s": 0.3, "mode": "hold"},
            {"at_s": 0.8, "mode": "active"},
            {"at_s": 1.0, "gains": gains},
            {"at_s": START_S, "push": {**first, "ramp_s": SLOW_S - START_S, "for_s": 60.0}},
            {"at_s": SLOW_S, "push": {**second, "ramp_s": LONG_S, "for_s": 60.0}},
        ],
    }
    log = context.lab(scenario, f"push_{'direct' if form == DIRECT else '_'.join(form)}")
    status(log, START_S, end)
    rows = motion(log, START_S, end)
    along = (rows["p_BT"][:, :2] - P_D) @ ALONG
    return Pushed(along, rows["F_push"][:, :2] @ ALONG, joints(rows)[:, 1])


def limit() -> float:
    """Greatest load under which there is a rest, N."""
    return float(closed_curve(SNAPS, 0.15)[:, 1].max())


def runs(context: Context) -> dict[Form, Pushed]:
    return {form: pushed(context, form, limit()) for form in (SNAPS, DIRECT)}


def checks(found: dict[Form, Pushed]) -> list[Check]:
    snapping, direct = found[SNAPS], found[DIRECT]
    stays = float(direct.load[-1] / K[0, 0])
    return [
        Check("the arm snaps to the other elbow at", limit(), snapping.snapped_at, "N", 0.05),
        Check("elbow afterwards", 0.0, float(snapping.elbow[-1]), "rad", 0.0, "at_most"),
        Check("direct law, deviation under 1.15 of that", stays, direct.deviation[-1], "m", 0.01),
    ]


def draw(found: dict[Form, Pushed], ax: Any) -> None:
    """The elbow's angle over the load; the arm's motion is what is measured."""
    for form, color in ((SNAPS, ORANGE), (DIRECT, BLACK)):
        run = found[form]
        ax.plot(run.load, np.degrees(run.elbow), color=color, label=f"{name(form)}, the arm")
    limit_N = limit()
    ax.axvline(limit_N, color="0.5", ls=":", lw=1)
    ax.annotate(
        "predicted:\nbeyond this it\ncannot rest",
        (limit_N, 20),
        xytext=(-8, 0),
        textcoords="offset points",
        ha="right",
    )
    ax.axhline(0, color="0.5", lw=0.8)
    ax.annotate("stretched", (0.3, 2), color="0.35")
    ax.set_title("The arm itself, pushed harder and harder")
    ax.set_xlabel("load (N)")
    ax.set_ylabel("angle of the elbow (°)")
    ax.legend(loc="lower left")
