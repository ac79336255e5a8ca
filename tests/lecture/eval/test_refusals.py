"""What is wrong with the input is said by case, law and key, and nothing is printed."""

import json

import pytest

from calculator import PLANAR, SEVEN, run

PD = {
    "q": [0.1, 0.2],
    "v": [0, 0],
    "q_d": [0, 0],
    "v_d": [0, 0],
    "Kp": [10, 10],
    "Kv": [1, 1],
    "bias": "gravity",
}
SEVENFOLD = {"q": [0.1] * 7, "p_d": [0, 0, 1], "R_d": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}
EQ4 = SEVENFOLD | {"Kx": [500] * 6}
TANK = {"E0": 1, "Emax": 2, "Emin": 0.5, "share": 1, "D": 1, "T": 1e-3}
TANK |= {"K_req": [1, 2], "e": [0, 0], "V": [0, 0]}


def case(law, inputs, robot=None):
    return {"law": law, "in": inputs} | ({"robot": robot} if robot else {})


def pd(**changes):
    return case("joint_pd", PD | changes, PLANAR)


def eq4(**changes):
    return case("eq4", EQ4 | changes, SEVEN)


def without(inputs, key):
    return {name: value for name, value in inputs.items() if name != key}


REFUSED = [
    (pd(q=[0.1]), "law joint_pd: q: expected 2 numbers, found a list of 1"),
    (pd(q=0.1), "q: expected 2 numbers, found 0.1"),
    (pd(q=[[0.1, 0.2]]), "q: expected 2 numbers, found 1 rows of 2"),
    (pd(q=["a", 0.2]), 'q[0]: expected a number, found "a"'),
    (pd(q=[None, 0.2]), "q[0]: expected a number, found null"),
    (pd(q=[True, 0.2]), "q[0]: expected a number, found true"),
    (pd(Kp=[[1, 2]]), "Kp: expected 2 rows of 2 numbers (or 2 numbers for a diagonal)"),
    (pd(Kp=[[1, 2], [3]]), "Kp: expected 2 rows of 2 numbers"),
    (pd(bias="gravty"), "bias: 'gravty' is none of none, gravity, gravity+coriolis; did you mean"),
    (pd(baes="none"), "baes is no input here"),
    (pd(bias=1), "bias: expected text, found 1"),
    (pd(Kd=[1, 1]), "Kd is no input here; there are: q, v, q_d, v_d, Kp, Kv, bias"),
    (
        case("joint_pd", without(PD, "Kv") | {"kv": [1, 1]}, PLANAR),
        "Kv is missing; given: q, v, q_d, v_d, Kp, bias, kv",
    ),
    (case("joint_pd", {}, PLANAR), "q is missing; given: nothing"),
    (case("joint_pd", PD), 'this law needs an arm: give the case a "robot"'),
    (case("joint_pd", PD, "planar3r"), "no robot 'planar3r'"),
    (case("joint_pd", PD, {"urdf": PLANAR["urdf"], "base": "base"}), "tip is missing"),
    (case("joint_pd", PD, PLANAR | {"tip": "tipp"}), "tipp"),
    (case("joint_pd", PD, PLANAR | {"gravity": [0, 1]}), "gravity: expected 3 numbers"),
    (case("joint_pd", PD, ["planar2r"]), "robot: expected a name, a folder or an object"),
    (case("joint_pdd", PD, PLANAR), "law: there is no 'joint_pdd', did you mean 'joint_pd'?"),
    (case("eq4", EQ4 | {"R_d": [[1, 0], [0, 1]]}, SEVEN), "R_d: expected 3 rows of 3 numbers"),
    (eq4(R_d=[[1, 0, 0], [0, 1, 0], [0, 0, 2]]), "R_d: expected a rotation matrix"),
    (eq4(R_d=[[1, 0, 0], [0, 1, 0], [0, 0, -1]]), "determinant -1"),
    (
        eq4(Kx=[1, 2]),
        "Kx: expected 6 rows of 6 numbers (or 6 numbers for a diagonal), found a list",
    ),
    (eq4(Kx=[[1] * 6] * 5), "found 5 rows of 6"),
    (
        eq4(Kx=[[1, 2, 0, 0, 0, 0]] + [[0] * 6] * 5),
        "Kx: expected a symmetric matrix, found [1][0] = 0 but [0][1] = 2",
    ),
    (eq4(Kx=[[0] * 6] * 5 + [[0] * 5 + ["x"]]), 'Kx[5][5]: expected a number, found "x"'),
    (eq4(mode="quaternion"), "mode: 'quaternion' is none of log, quat"),
    (case("eq4", {"q": [0, 1], "p_d": [0, 0, 0], "Kx": [1, 1]}, PLANAR), "p_d: expected 2 numbers"),
    (
        case("eq4", {"q": [0, 1], "p_d": [0, 0], "Kx": [1, 1], "R_d": 1}, PLANAR),
        "R_d is no input here",
    ),
    (
        case("damping_design", {"q": [0, 1], "Kx": [1, -1], "zeta": 1}, PLANAR),
        "Kx: expected a positive semidefinite matrix, found one with the eigenvalue -1",
    ),
    (case("singularity", {"q": [0, 1], "sigma0": 0, "lam_max": 1}, PLANAR), "sigma0: expected a"),
    (
        case("qbar", {"theta": [0, 1], "p_d": [0, 0], "Kx": [1e5, 1e5], "K": [9, 9]}, PLANAR),
        "there is no equilibrium to use",
    ),
    (case("tank_seq", TANK | {"E0": 3}), "an energy tank needs 0 <= E_min <= E_0 <= E_max"),
    (case("tank_seq", TANK | {"V": [0]}), "V: expected a list of 2 samples, found a list of 1"),
    (case("tank_seq", TANK | {"e": []}), "e: expected a list of samples, found an empty list"),
    (case("vsa", {"sigma": 0, "tau": 1, "q": 0, "k2": 1}), "sigma: expected numbers above 0"),
    (case("limit_seq", []), "in: expected an object, found an empty list"),
    ({"law": "vsa"}, "in is missing"),
    ({"in": {}}, "law is missing"),
    ({"law": "vsa", "in": {}, "robt": 1}, "robt is no input here, did you mean 'robot'?"),
    (7, "expected an object, found 7"),
]


@pytest.mark.parametrize(("wrong", "complaint"), REFUSED)
def test_a_wrong_case_is_refused(wrong, complaint):
    done = run(json.dumps(wrong))
    assert done.returncode == 2
    assert done.stdout == ""
    assert complaint in done.stderr
    assert done.stderr.startswith("limber-eval: standard input: ")


TEXTS = [
    ("", "this is no JSON"),
    ("{", "line 1, column 2"),
    ('{"law": "vsa", "in": {"sigma": NaN}}', "this is no JSON"),
    ('{"law": "vsa", "in": {"sigma": 1e999}}', "number overflow parsing '1e999'"),
    ('{"law": "vsa", "law": "eq4", "in": {}}', 'the key "law" is given twice'),
    ('{"law": "vsa", "in": {}} {}', "this is no JSON"),
]


@pytest.mark.parametrize(("text", "complaint"), TEXTS)
def test_what_is_no_json_is_refused(text, complaint):
    done = run(text)
    assert (done.returncode, done.stdout) == (2, "")
    assert complaint in done.stderr


def test_one_wrong_case_of_a_list_is_named_and_nothing_is_printed():
    done = run(json.dumps([pd(), pd(), pd(q=[1])]))
    assert (done.returncode, done.stdout) == (2, "")
    assert "case 3 of 3: law joint_pd: q: expected 2 numbers" in done.stderr


def test_an_unknown_law_lists_all():
    done = run(json.dumps(case("impedance", {})))
    names = run("", "--list").stdout.split()
    assert len(names) == 32
    assert all(f"{name}" in done.stderr for name in names)


def test_a_result_that_is_not_finite_is_refused():
    huge = case(
        "deflection_pd", {"q": 1e308, "v": 0, "theta": -1e308, "thetad": 0} | {"Kpm": 1e9, "Kvm": 0}
    )
    done = run(json.dumps(huge))
    assert (done.returncode, done.stdout) == (2, "")
    assert "the output tau_m is not finite" in done.stderr


ARGUMENTS = [
    (["--urdf", "a.urdf"], "--base"),
    (["--base", "a"], "--urdf"),
    (["--robot", "openarm", "--urdf", "a", "--base", "b", "--tip", "c"], "--robot"),
    (["--urdf", "a", "--base", "b", "--tip", "c", "--gravity", "1,2"], "--gravity"),
    (["nowhere.json"], "nowhere.json: cannot be read"),
    (["--robt", "a"], "--robt"),
]


@pytest.mark.parametrize(("arguments", "complaint"), ARGUMENTS)
def test_wrong_arguments_are_refused(arguments, complaint):
    done = run(json.dumps(pd()), *arguments)
    assert (done.returncode, done.stdout) == (2, "")
    assert complaint in done.stderr
