"""What experiments on the arm measure and predict with, on systems whose answer is known."""

import numpy as np
import pytest
import yaml
from made_logs import records, write_log

from limber import messages
from limber.errors import RunError
from limber.log.reader import Log, time_s
from limber.model.robot import load_robot
from limber_lecture import planar2r
from limber_lecture.inertia import gravity_gradient, joint_inertia, tip_inertia
from limber_lecture.ringdown import modes_of, modes_seen
from limber_lecture.truth import motion, status
from limber_lecture.variants import TIP_SENSOR, variant

PERIOD_NS = 1_000_000
STATUS = messages.message_class("controller_status_t")


def test_a_mass_on_a_spring_has_its_textbook_mode():
    m, d, k = 2.0, 3.0, 50.0
    (mode,) = modes_of(np.array([[m]]), np.array([[d]]), np.array([[k]]), 1)
    assert mode.omega == pytest.approx(np.sqrt(k / m))
    assert mode.zeta == pytest.approx(d / (2 * np.sqrt(k * m)))


def test_modes_are_read_off_a_free_motion_around_any_rest():
    omega, zeta, rest, step = np.array([5.0, 20.0]), np.array([0.1, 0.3]), 0.7, 0.005
    t = np.arange(0, 2, step)[:, None]
    s = -zeta * omega + 1j * omega * np.sqrt(1 - zeta**2)
    swing = np.exp(s * t) * np.array([1.0, 0.5])
    x, v = swing.real, (s * swing).real
    mix = np.array([[1.0, 0.4], [-0.3, 1.0]])
    seen = modes_seen([np.hstack([x @ mix + rest, v @ mix])], step, 2)
    assert [mode.omega for mode in seen] == pytest.approx(omega)
    assert [mode.zeta for mode in seen] == pytest.approx(zeta)
    with pytest.raises(RunError, match="2 modes swing, 1 should"):
        modes_seen([np.hstack([x @ mix, v @ mix])], step, 1)


def test_inertia_from_the_urdf_is_the_closed_form():
    q = np.array([0.3, -1.1])
    M = joint_inertia("planar2r", q)
    assert pytest.approx(planar2r.inertia(q), rel=1e-9) == M
    J = planar2r.jacobian(q)
    assert np.linalg.inv(tip_inertia(J, M)) == pytest.approx(J @ np.linalg.inv(M) @ J.T)


def test_gravity_gradient_is_that_of_two_hanging_rods():
    """∂g/∂q of m g (height of each centre); gravity along -y."""
    q, (l1, l2), (m1, m2) = np.array([0.4, 0.9]), planar2r.LENGTHS, planar2r.MASSES
    inner = -(m1 / 2 + m2) * 9.81 * l1 * np.sin(q[0])
    outer = -m2 * 9.81 * l2 / 2 * np.sin(q.sum())
    expected = np.array([[inner + outer, outer], [outer, outer]])
    assert gravity_gradient("planar2r", q) == pytest.approx(expected, rel=1e-6)


def test_seven_joints_have_a_definite_inertia():
    robot = load_robot("ideal7")
    M = joint_inertia("ideal7", np.linspace(-1, 1, len(robot.joints)))
    assert pytest.approx(M.T) == M
    assert np.linalg.eigvalsh(M).min() > 0


@pytest.fixture
def log(tmp_path):
    def write(
        limits: int = STATUS.LIMIT_RAMP, mode: int = STATUS.MODE_ACTIVE, refused: int = 0
    ) -> Log:
        times = np.arange(100) * PERIOD_NS
        told = records("controller_status_t", 100, time_ns=times, mode=mode)
        told["limits"][50] = limits
        told["requests_refused"][60:] = refused
        truth = records("sim_truth_t", 100, time_ns=times)
        return Log(
            write_log(tmp_path / "x.lcmlog", {"CONTROLLER_STATUS": told, "SIM_TRUTH": truth})
        )

    return write


def test_a_part_of_a_run_is_cut_out(log):
    t = time_s(motion(log(), 0.02, 0.03))
    assert t == pytest.approx(np.arange(20, 30) * 1e-3)
    with pytest.raises(RunError, match=r"ends before 0\.2 s"):
        motion(log(), 0.0, 0.2)


@pytest.mark.parametrize(
    ("what", "said"),
    [
        ({"limits": STATUS.LIMIT_TORQUE}, "limits act: TORQUE"),
        ({"mode": STATUS.MODE_FAULT}, "not active"),
        ({"refused": 2}, "refused 2 requests"),
    ],
)
def test_a_run_in_which_more_than_the_law_acted_is_refused(log, what, said):
    with pytest.raises(RunError, match=said):
        status(log(**what), 0.0, 0.09)
    assert len(status(log(), 0.0, 0.09)) == 90


def test_a_variant_differs_in_what_is_said_only(tmp_path):
    changes = {"tip_sensor": {**TIP_SENSOR, "bus": "arm"}, "joints": {"elbow": {"id": 9}}}
    folder = variant(tmp_path, "planar2r", changes)
    with open(f"{folder}/robot.yaml", encoding="utf-8") as file:
        changed = yaml.safe_load(file)
    with open(load_robot("planar2r").folder / "robot.yaml", encoding="utf-8") as file:
        original = yaml.safe_load(file)
    assert changed.pop("tip_sensor")["bus"] == "arm"
    assert changed["joints"]["elbow"].pop("id") == 9
    original["joints"]["elbow"].pop("id")
    assert changed == original
