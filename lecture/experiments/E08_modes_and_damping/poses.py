"""Three ways to choose the damping, judged by the modes they leave at many poses."""

import numpy as np
from scipy.linalg import sqrtm

from limber_lecture.context import Comparison, Context, at_least, at_most, case, near_zero
from limber_lecture.pictures import BLACK, BLUE, GREEN, ORANGE, Axes, name_axes, note
from limber_lecture.ringdown import roots_of

ROBOT = "ideal7"
K = np.diag([1000.0] * 3 + [30.0] * 3)
ZETA, POSES = 0.7, 30

Ratios = dict[str, np.ndarray]


def damping_ratios(context: Context) -> Ratios:
    """For each design the ratios of the six modes at random poses; 1: does not swing."""
    poses = context.rng.uniform(-1.6, 1.6, (POSES, 7))
    answers = context.eval([case("damping_design", ROBOT, q=q, Kx=K, zeta=ZETA) for q in poses])
    found: Ratios = {}
    for answer in answers:
        designs = {
            "double diagonalization": answer["D_double_diag"],
            "factorization": answer["D_factorization"],
            "2ζ√K without the inertia": 2 * ZETA * np.real(sqrtm(K)),
        }
        for name, D in designs.items():
            found.setdefault(name, []).append(_modes(answer["Lambda"], D))
    return {name: np.concatenate(values) for name, values in found.items()}


def _modes(L: np.ndarray, D: np.ndarray) -> np.ndarray:
    """-Re s/|s| of the roots of Λ s² + D s + K."""
    s = roots_of(L, D, K)
    return -s.real / np.abs(s)


def checks(ratios: Ratios) -> list[Comparison]:
    exact = np.abs(ratios["double diagonalization"] - ZETA).max()
    careless = ratios["2ζ√K without the inertia"]
    spread = careless.max() / careless.min()
    return [
        near_zero("double diagonalization: ratio off by", exact, "", 1e-6),
        at_most("factorization: lowest ratio", ZETA, ratios["factorization"].min()),
        at_least("2ζ√K: greatest ratio over lowest", 2.0, spread),
    ]


def draw(ratios: Ratios, ax: Axes) -> None:
    bins = np.linspace(-0.0125, 1.0125, 42)
    colors = (BLUE, GREEN, ORANGE)
    for (name, values), color in zip(ratios.items(), colors, strict=True):
        # each mode that swings has two roots
        share = np.full(len(values), 100 / len(values))
        ax.hist(values, bins, weights=share, color=color, alpha=0.6, label=name)
    ax.axvline(ZETA, color=BLACK, ls="--", lw=1.2)
    note(ax, "asked for", (ZETA, 60), (-6, 0), ha="right", color=BLACK)
    ax.set_yscale("symlog", linthresh=5)
    ax.set_ylim(0, 130)
    ax.set_yticks([0, 2, 5, 10, 20, 50, 100], ["0", "2", "5", "10", "20", "50", "100"])
    ax.set_title("Six modes at 30 poses of a seven-joint arm")
    name_axes(
        ax, "damping ratio of a mode (1: does not swing)", "share of the modes (%)", "upper left"
    )
