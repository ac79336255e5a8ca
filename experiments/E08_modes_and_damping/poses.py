"""Three ways to choose the damping, judged by the modes they leave at many poses."""

from typing import Any

import numpy as np
from scipy.linalg import sqrtm

from limber.experiments.check import Check
from limber.experiments.context import Context
from limber.experiments.evaluate import case
from limber.experiments.pictures import BLACK, BLUE, GREEN, ORANGE

ROBOT = "ideal7"
K = np.diag([1000.0] * 3 + [30.0] * 3)
ZETA, POSES = 0.7, 30

Ratios = dict[str, np.ndarray]


def damping_ratios(context: Context) -> Ratios:
    """For each design the ratios of the six modes at each pose; 1 for those that do not swing."""
    found: Ratios = {}
    for answer in _answers(context):
        L = answer["Lambda"]
        designs = {
            "double diagonalization": answer["D_double_diag"],
            "factorization": answer["D_factorization"],
            "2ζ√K without the inertia": 2 * ZETA * np.real(sqrtm(K)),
        }
        for name, D in designs.items():
            found.setdefault(name, []).append(_modes(L, D))
    return {name: np.concatenate(values) for name, values in found.items()}


def _answers(context: Context) -> list[dict[str, Any]]:
    """At random poses."""
    poses = context.rng.uniform(-1.6, 1.6, (POSES, 7))
    return context.eval([case("damping_design", ROBOT, q=q, Kx=K, zeta=ZETA) for q in poses])


def _modes(L: np.ndarray, D: np.ndarray) -> np.ndarray:
    """-Re s/|s| of the roots of Λ s² + D s + K."""
    n = len(L)
    companion = np.block(
        [[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(L, K), -np.linalg.solve(L, D)]]
    )
    s = np.linalg.eigvals(companion)
    return -s.real / np.abs(s)


def checks(ratios: Ratios) -> list[Check]:
    exact = float(np.abs(ratios["double diagonalization"] - ZETA).max())
    lowest = float(ratios["factorization"].min())
    careless = ratios["2ζ√K without the inertia"]
    return [
        Check("double diagonalization: ratio off by", 0.0, exact, "", 1e-6, "absolute"),
        Check("factorization: lowest ratio", ZETA, lowest, "", 0.0, "at_most"),
        Check(
            "2ζ√K: greatest ratio over lowest",
            2.0,
            float(careless.max() / careless.min()),
            "",
            0.0,
            "at_least",
        ),
    ]


def draw(ratios: Ratios, ax: Any) -> None:
    bins = np.linspace(-0.0125, 1.0125, 42)
    colors = (BLUE, GREEN, ORANGE)
    for (name, values), color in zip(ratios.items(), colors, strict=True):
        # each mode that swings has two roots
        share = np.full(len(values), 100 / len(values))
        ax.hist(values, bins, weights=share, color=color, alpha=0.6, label=name)
    ax.axvline(ZETA, color=BLACK, ls="--", lw=1.2)
    ax.annotate("asked for", (ZETA, 60), xytext=(-6, 0), textcoords="offset points", ha="right")
    ax.set_yscale("symlog", linthresh=5)
    ax.set_ylim(0, 130)
    ax.set_yticks([0, 2, 5, 10, 20, 50, 100], ["0", "2", "5", "10", "20", "50", "100"])
    ax.set_title("Six modes at 30 poses of a seven-joint arm")
    ax.set_xlabel("damping ratio of a mode (1: does not swing)")
    ax.set_ylabel("share of the modes (%)")
    ax.legend(loc="upper left")
