"""The damped inverse of the Jacobian near the stretched pose, asked of the controller."""

import numpy as np

from limber_lecture import planar2r as arm
from limber_lecture.context import Comparison, Context, at_most, case, near_zero
from limber_lecture.pictures import BLUE, MEASURED, ORANGE, Axes, level, name_axes

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


def checks(found: np.ndarray) -> list[Comparison]:
    norm, damping = found
    off = max(abs(n / predicted(elbow) - 1) for elbow, n in zip(ELBOWS, norm, strict=True))
    return [
        near_zero("damped inverse: norm off by", off, "", 1e-6),
        at_most("damped inverse: norm times 2λ", 1.0, (norm * 2 * damping).max(), "", 1e-9),
        at_most("damped inverse: greatest norm", GREATEST, norm.max(), "1/m"),
    ]


def draw(found: np.ndarray, ax: Axes) -> None:
    angles = np.linspace(1e-3, 0.8, 200)
    least = [np.linalg.svd(arm.jacobian(np.array([0.3, a])), compute_uv=False)[-1] for a in angles]
    ax.plot(np.degrees(angles), 1 / np.array(least), "--", color=ORANGE, label="exact: 1/σ")
    ax.plot(np.degrees(angles), [predicted(a) for a in angles], color=BLUE, label="damped")
    ax.plot(np.degrees(ELBOWS), found[0], **MEASURED, color=BLUE, label="the controller's")
    level(ax, "bound", (46, GREATEST), (0, 3), ha="right")
    ax.set_ylim(0, 20)
    ax.set_title("Joint speed for a speed of the tip")
    name_axes(ax, "angle of the elbow (°); 0: stretched", "norm of the inverse (1/m)", "best")
