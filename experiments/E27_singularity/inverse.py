"""The damped inverse of the Jacobian near the stretched pose, asked of the controller."""

from typing import Any

import numpy as np

from limber.experiments import planar2r as arm
from limber.experiments.check import Check
from limber.experiments.context import Context
from limber.experiments.evaluate import case
from limber.experiments.pictures import BLUE, MEASURED, ORANGE

SIGMA_0, LAMBDA_MAX = 0.1, 0.05
ELBOWS = np.array([1e-6, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8])  # rad


# What is left of 1/σ: σ/(σ² + λ²) is greatest where σ² = λ_max²/(1 - λ_max²/σ_0²)
GREATEST = 1 / (2 * LAMBDA_MAX * np.sqrt(1 - (LAMBDA_MAX / SIGMA_0) ** 2))


def norms(context: Context) -> np.ndarray:
    """‖J⁺_λ‖ and λ at each angle of the elbow; one column an angle."""
    asked = {"sigma0": SIGMA_0, "lam_max": LAMBDA_MAX}
    cases = [case("singularity", arm.ROBOT, q=[0.3, elbow], **asked) for elbow in ELBOWS]
    answers = context.eval(cases)
    return np.array([[np.linalg.norm(a["J_damped_pinv"], 2), a["lam"]] for a in answers]).T


def predicted(elbow: float) -> float:
    """Largest σ/(σ² + λ²), λ² = λ_max² (1 - (σ_min/σ_0)²) below σ_0."""
    s = np.linalg.svd(arm.jacobian(np.array([0.3, elbow])), compute_uv=False)
    damping = LAMBDA_MAX**2 * max(0.0, 1 - (s[-1] / SIGMA_0) ** 2)
    return float((s / (s**2 + damping)).max())


def checks(found: np.ndarray) -> list[Check]:
    norm, damping = found
    off = max(abs(n / predicted(elbow) - 1) for elbow, n in zip(ELBOWS, norm, strict=True))
    share = float((norm * 2 * damping).max())
    worst = float(norm.max())
    return [
        Check("damped inverse: norm off by", 0.0, float(off), "", 1e-6, "absolute"),
        Check("damped inverse: norm times 2λ", 1.0, share, "", 1e-9, "at_most"),
        Check("damped inverse: greatest norm", GREATEST, worst, "1/m", 0.0, "at_most"),
    ]


def draw(found: np.ndarray, ax: Any) -> None:
    angles = np.linspace(1e-3, 0.8, 200)
    least = [np.linalg.svd(arm.jacobian(np.array([0.3, a])), compute_uv=False)[-1] for a in angles]
    ax.plot(np.degrees(angles), 1 / np.array(least), "--", color=ORANGE, label="exact: 1/σ")
    ax.plot(np.degrees(angles), [predicted(a) for a in angles], color=BLUE, label="damped")
    ax.plot(np.degrees(ELBOWS), found[0], **MEASURED, color=BLUE, label="the controller's")
    ax.axhline(GREATEST, color="0.5", ls=":", lw=1)
    ax.annotate("bound", (46, GREATEST + 0.2), ha="right", color="0.35")
    ax.set_ylim(0, 20)
    ax.set_title("Joint speed for a speed of the tip")
    ax.set_xlabel("angle of the elbow (°); 0: stretched")
    ax.set_ylabel("norm of the inverse (1/m)")
    ax.legend()
