"""Every law against its equation, written again with numpy and scipy, for random inputs."""

import numpy as np
import pytest

import arm_laws
import other_laws
from draw import Draw, arm_inputs, other_inputs

CASES = 12
TOLERANCE = 1e-6
# Tangents that are differenced, here and there.
DIFFERENCED = {"eq4": ("full",), "eq7": ("tau", "Kp")}


def check(law, inputs, output, expected):
    assert list(output) == list(expected)
    for key, value in expected.items():
        value = np.asarray(value)
        assert output[key].shape == value.shape, key
        tolerance = 1e-4 if key in DIFFERENCED.get(law, ()) else TOLERANCE
        scale = np.abs(value.astype(float)).max()
        miss = np.abs(output[key].astype(float) - value).max()
        # what is zero in one may be rounding in the other
        assert miss <= tolerance * scale + 1e-11, f"{law}: {key} is off by {miss}: {inputs}"


@pytest.mark.parametrize("law", arm_laws.LAWS)
def test_law_of_an_arm(law, arm, evaluate):
    reference, name = arm
    inputs = [arm_inputs(law, Draw(seed, reference)) for seed in range(CASES)]
    outputs = evaluate([{"law": law, "robot": name, "in": case} for case in inputs])
    for case, output in zip(inputs, outputs, strict=True):
        check(law, case, output, arm_laws.LAWS[law](reference, **case))


@pytest.mark.parametrize("law", other_laws.LAWS)
def test_law_without_an_arm(law, evaluate):
    inputs = [other_inputs(law, Draw(seed)) for seed in range(CASES)]
    outputs = evaluate([{"law": law, "in": case} for case in inputs])
    for case, output in zip(inputs, outputs, strict=True):
        check(law, case, output, other_laws.LAWS[law](**case))


def test_one_joint_may_be_written_as_a_number(evaluate):
    """The same numbers come back, as numbers instead of lists of one."""
    drive = {"B": 0.7, "Btheta": 0.2, "K": 900.0, "D": 4.0}
    signals = {"u": 3.0, "tau": 2.0, "taud": -40.0}
    listed = {key: [value] for key, value in (drive | signals).items()}
    bare, lists = evaluate(
        [
            {"law": "torque_feedback", "in": drive | signals},
            {"law": "torque_feedback", "in": listed},
        ]
    )
    assert bare["tau_m"].shape == () and lists["tau_m"].shape == (1,)
    assert bare["tau_m"] == lists["tau_m"][0]
    rho = 0.7 / 0.2
    assert bare["tau_m"] == pytest.approx(rho * 3.0 + (1 - rho) * (2.0 - 4.0 / 900.0 * 40.0))
