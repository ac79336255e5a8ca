"""The program around the laws: where the arm comes from, what is printed, the command line."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from arms import Planar2R
from calculator import PLANAR, run

G = {"q": [0.3, 0.9], "v": [0.0, 0.0], "W": [0.0, 0.0]}
CASE = {"law": "kin_dyn", "in": G}
URDF = ("--urdf", PLANAR["urdf"], "--base", "base", "--tip", "tip")
VERTICAL = (*URDF, "--gravity", "0,-9.81,0")


def gravity(done) -> np.ndarray:
    assert done.returncode == 0, done.stderr
    return np.array(json.loads(done.stdout)["g"])


def test_the_command_line_names_the_arm_of_cases_that_name_none():
    expected = Planar2R().g(np.array(G["q"]))
    np.testing.assert_allclose(gravity(run(json.dumps(CASE), *VERTICAL)), expected, rtol=1e-12)


def test_gravity_points_down_if_nothing_is_said():
    np.testing.assert_allclose(gravity(run(json.dumps(CASE), *URDF)), 0.0, atol=1e-12)


def test_the_arm_of_a_case_comes_first():
    both = run(json.dumps(CASE | {"robot": PLANAR}), *URDF)
    np.testing.assert_allclose(gravity(both), Planar2R().g(np.array(G["q"])), rtol=1e-12)


def test_a_robot_is_found_by_name_and_by_folder():
    by_name = run(json.dumps(CASE | {"robot": "openarm", "in": {"q": [0.1] * 7}}))
    folder = Path(__file__).resolve().parents[3] / "robots" / "openarm"
    by_folder = run(json.dumps(CASE | {"in": {"q": [0.1] * 7}}), "--robot", str(folder))
    assert len(gravity(by_name)) == 7
    assert by_name.stdout == by_folder.stdout


def test_laws_count_the_rotors_and_M_does_not():
    """Without gravity and motion, tau = (M + diag(B)) a_d."""
    zero = [0.0] * 7
    inputs = {"q": zero, "q_d": zero, "a_d": [1.0] + [0.0] * 6, "Kp_acc": 1, "Kv_acc": 1}
    cases = [
        {"law": "computed_torque", "robot": "openarm", "in": inputs},
        {"law": "kin_dyn", "robot": "openarm", "in": {"q": zero}},
    ]
    done = run(json.dumps(cases))
    law, terms = json.loads(done.stdout)
    rotors = np.array(law["tau"]) - np.array(terms["g"]) - np.array(terms["M"])[:, 0]
    assert rotors[0] > 0.01
    np.testing.assert_allclose(rotors[1:], 0.0, atol=1e-12)


def test_one_case_gives_an_object_and_a_list_gives_a_list(tmp_path):
    file = tmp_path / "cases.json"
    file.write_text(json.dumps([CASE, CASE]), encoding="utf-8")
    single = run(json.dumps(CASE), *VERTICAL)
    double = run("", str(file), *VERTICAL)
    assert json.loads(double.stdout) == [json.loads(single.stdout)] * 2
    assert run("[]").stdout == "[]\n"


def test_numbers_come_back_to_the_last_bit():
    value = 0.1 + 0.2
    zero = {"q": 0, "v": 0, "theta": 0, "thetad": -1, "Kpm": 1, "Kvm": value}
    done = run(json.dumps({"law": "deflection_pd", "in": zero}))
    assert json.loads(done.stdout)["tau_m"] == value


@pytest.mark.parametrize("through_a_pipe", [False, True])
def test_the_command_line_passes_through(tmp_path, through_a_pipe):
    file = tmp_path / "case.json"
    file.write_text(json.dumps(CASE), encoding="utf-8")
    tools = Path(__file__).resolve().parents[3] / "tools"
    done = subprocess.run(
        [
            sys.executable,
            "-m",
            "limber",
            "eval",
            *([] if through_a_pipe else [str(file)]),
            *VERTICAL,
        ],
        input=file.read_text(encoding="utf-8") if through_a_pipe else "",
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
        env=os.environ | {"PYTHONPATH": str(tools)},
    )
    np.testing.assert_allclose(gravity(done), Planar2R().g(np.array(G["q"])), rtol=1e-12)
