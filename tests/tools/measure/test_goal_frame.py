"""`frame: goal`: what is expected of a push is in the axes that the law works in.

d = R K⁻¹ Rᵀ F, and the stiffness met along a push is F² / (F · d).
"""

import json

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

HOME = Rotation.from_quat([0.219007, 0.0, 0.975723, 0.0], scalar_first=True)  # of ideal7's tip
TIMELINE = """duration_s: {duration}
seed: 1
friction: false
integrator: reference
timeline:
  - {{at_s: 0.3, mode: hold}}
  - {{at_s: 0.8, mode: active}}
  - {{at_s: 1.0, gains: {{law: cartesian_impedance, K_x_translation_N_per_m: 1000,
     K_x_rotation_Nm_per_rad: 30, damping_ratio: 0.7, ramp_s: 0.2}}}}
"""
PUSH = "  - {{at_s: {at}, push: {{force_N: [{force}], ramp_s: 0.2, for_s: 3}}}}\n"
FORCES = np.eye(3) * 6.0


def timeline(gains: str, forces, also: str = "") -> str:
    text = (
        TIMELINE.format(duration=4 + 4 * len(forces)) + f"  - {{at_s: 1.3, gains: {{{gains}}}}}\n"
    )
    for i, force in enumerate(forces):
        numbers = ", ".join(f"{x:g}" for x in force)
        text += PUSH.format(at=2.5 + 4 * i, force=numbers)
    return text + also


def measured(limber, scenario_file, tmp_path, text: str) -> list[dict]:
    done = limber("lab", str(scenario_file("ideal7", text)), "--out", str(tmp_path / "out"))
    results = json.loads((tmp_path / "out" / "summary.json").read_text())["results"]
    assert done.returncode == 0, done.stdout
    return [result for result in results if result["name"].startswith("stiffness")]


def along(R: Rotation, K, force) -> float:
    C = R.as_matrix() @ np.diag(1.0 / np.asarray(K, float)) @ R.as_matrix().T
    return float(force @ force / (force @ C @ force))


@pytest.mark.parametrize(
    ("gains", "K"),
    [
        ("frame: goal, K_x_translation_N_per_m: [1500, 1500, 300], ramp_s: 0.2", [1500, 1500, 300]),
        ("frame: goal, K_x_translation_N_per_m: [300, 1500, 900], ramp_s: 0.2", [300, 1500, 900]),
    ],
)
def test_soft_along_an_axis_of_the_goal(limber, scenario_file, tmp_path, gains, K):
    gains += ", K_x_rotation_Nm_per_rad: 60"
    results = measured(limber, scenario_file, tmp_path, timeline(gains, FORCES))
    for result, force in zip(results, FORCES, strict=True):
        assert result["expected"] == pytest.approx(along(HOME, K, force), rel=2e-3)
        assert result["value"] == pytest.approx(result["expected"], rel=5e-3) and result["pass"]


def test_an_oblique_push_and_a_reset(limber, scenario_file, tmp_path):
    """`reset` goes back to base axes."""
    K = [1200, 1200, 400]
    gains = f"frame: goal, K_x_translation_N_per_m: {K}, K_x_rotation_Nm_per_rad: 60, ramp_s: 0.2"
    oblique = np.array([3.0, 2.0, 4.0])
    text = timeline(gains, [oblique, FORCES[0]])
    text += (
        "  - {at_s: 6.0, gains: {reset: true, law: cartesian_impedance, "
        "K_x_translation_N_per_m: [700, 900, 900], K_x_rotation_Nm_per_rad: 60, ramp_s: 0.2}}\n"
    )
    first, second = measured(limber, scenario_file, tmp_path, text)
    assert first["expected"] == pytest.approx(along(HOME, K, oblique), rel=2e-3) and first["pass"]
    assert second["expected"] == pytest.approx(700, rel=1e-3) and second["pass"]
