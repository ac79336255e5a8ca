"""The measurement finds the stiffness a log was made with, and says no when it is another one.

The logs are made from statics: the tip is where the spring K_true lets the push put it.
"""

import numpy as np
import pytest
from made_logs import RATE_HZ, records, write_log
from scipy.optimize import fsolve, linprog
from scipy.spatial.transform import Rotation

from limber.log.reader import Log
from limber.measure import statics
from limber.measure.pushes import measure_pushes, stiffness_matrix
from limber.measure.summarize import measure
from limber.model.robot import SpringPair, load_robot

HOME = np.array([0.3, 0.3, 0.0, 1.4, 0.0, 0.0, 0.0])
AXES = {
    "+x": "force_N: [20, 0, 0]",
    "-x": "force_N: [-20, 0, 0]",
    "+y": "force_N: [0, 20, 0]",
    "+z": "force_N: [0, 0, 20]",
    "+rx": "torque_Nm: [1, 0, 0]",
    "+ry": "torque_Nm: [0, 1, 0]",
    "+rz": "torque_Nm: [0, 0, 1]",
}


def timeline(axes=AXES, extra="") -> str:
    lines = ["timeline:", *([extra] if extra else [])]
    for i, axis in enumerate(axes):
        lines.append(f"  - {{at_s: {1 + 2 * i}, push: {{{AXES[axis]}, ramp_s: 0.2, for_s: 1.2}}}}")
    return f"duration_s: {1 + 2 * len(axes)}\n" + "\n".join(lines) + "\n"


def truth_of(scenario, C: np.ndarray, q=HOME, friction_N=0.0) -> np.ndarray:
    """SIM_TRUTH of an arm whose tip follows pushes by C; friction takes `friction_N` of each."""
    t = np.arange(int(scenario.duration_s * RATE_HZ)) / RATE_HZ
    F = np.zeros((len(t), 6))
    for push in scenario.pushes:
        inside = np.clip((t - push.at_s) / push.ramp_s, 0, 1)
        inside *= np.clip((push.at_s + push.duration_s - t) / push.ramp_s, 0, 1)
        F += inside[:, None] * push.wrench
    size = np.linalg.norm(F, axis=1, keepdims=True)
    felt = F * np.clip(1 - friction_N / np.maximum(size, 1e-9), 0, 1)
    moved = felt @ C.T
    truth = records("sim_truth_t", len(t), num_joints=len(q), time_ns=(t * 1e9).astype(np.int64))
    truth["q"][:, : len(q)] = q
    X_BT = scenario.robot.chain.forward(q)
    truth["p_BT"] = X_BT[:3, 3] + moved[:, :3]
    R_BT = Rotation.from_rotvec(moved[:, 3:]) * Rotation.from_matrix(X_BT[:3, :3])
    truth["quat_BT"] = R_BT.as_quat(scalar_first=True)
    # the sign of a quaternion means nothing and must not matter
    truth["quat_BT"][::2] *= -1
    truth["F_push"] = F
    truth["tau_friction"][:, : len(q)] = (felt - F) @ scenario.robot.chain.jacobian(q)
    return truth


def state_of(truth: np.ndarray) -> np.ndarray:
    return records("joint_state_t", len(truth), time_ns=truth["time_ns"], num_joints=7)


def driver_of(truth: np.ndarray, **fields) -> np.ndarray:
    last = records("driver_status_t", 1, time_ns=truth["time_ns"][-1], lockstep=1, cycles=10)
    for name, value in fields.items():
        last[name] = value
    return last


def pushes_of(tmp_path, scenario, truth):
    return measure_pushes(Log(write_log(tmp_path / "p.lcmlog", {"SIM_TRUTH": truth})), scenario)


def measured(tmp_path, scenario, truth, **driver_fields):
    channels = {
        "SIM_TRUTH": truth,
        "JOINT_STATE": state_of(truth),
        "DRIVER_STATUS": driver_of(truth, **driver_fields),
    }
    log = Log(write_log(tmp_path / "run.lcmlog", channels))
    return measure(log, scenario, "lockstep")[0]


@pytest.fixture
def still(scenario):
    """openarm with seven pushes and no friction: K_x as in its robot.yaml."""
    return scenario("openarm", "friction: false\n" + timeline())


def test_right_stiffness_passes(tmp_path, still):
    truth = truth_of(still, np.linalg.inv(still.robot.K_x))
    summary = measured(tmp_path, still, truth)
    assert summary.passed
    K_x = np.diag(still.robot.K_x)
    for axis, asked in zip(("+x", "+y", "+z", "+rx", "+ry", "+rz"), K_x, strict=True):
        result = summary.find(f"stiffness {axis}")
        assert result.expected == pytest.approx(asked)
        assert result.value == pytest.approx(asked, rel=1e-3), axis
    assert summary.find("stiffness -x").value == pytest.approx(K_x[0], rel=1e-3)
    assert summary.find("stiffness matrix, off by").value < 1e-3


@pytest.mark.parametrize("axis", range(6))
def test_three_percent_off_in_one_axis_fails(tmp_path, still, axis):
    K = still.robot.K_x.copy()
    K[axis, axis] *= 1.03
    summary = measured(tmp_path, still, truth_of(still, np.linalg.inv(K)))
    assert not summary.passed
    wrong = {r.name for r in summary.results if r.passed is False and r.name[10] in "+-"}
    names = ("+x", "+y", "+z", "+rx", "+ry", "+rz")
    assert f"stiffness {names[axis]}" in wrong
    assert len(wrong) == (2 if axis == 0 else 1)


def test_tolerance_of_the_scenario(tmp_path, scenario):
    text = "friction: false\nmeasure: {stiffness: 0.05}\n" + timeline()
    loose = scenario("openarm", text)
    summary = measured(tmp_path, loose, truth_of(loose, np.linalg.inv(1.03 * loose.robot.K_x)))
    assert summary.passed


def test_coupling_shows_in_the_matrix_only(tmp_path, still):
    """A coupling that single pushes hardly see must fail the 6x6 comparison."""
    K = still.robot.K_x.copy()
    K[0, 1] = K[1, 0] = 0.1 * K[0, 0]
    summary = measured(tmp_path, still, truth_of(still, np.linalg.inv(K)))
    off = summary.find("stiffness matrix, off by")
    # ‖ΔK‖ / ‖K‖ scaled by the diagonal: two entries of 0.1 against six ones
    assert off.value == pytest.approx(np.sqrt(2 * 0.1**2) / np.sqrt(6), rel=0.02)
    assert off.passed is False


def test_matrix_needs_all_axes(tmp_path, scenario):
    few = scenario(
        "openarm", "friction: false\n" + timeline(("+x", "-x", "+y", "+z", "+rx", "+ry"))
    )
    truth = truth_of(few, np.linalg.inv(few.robot.K_x))
    assert stiffness_matrix(pushes_of(tmp_path, few, truth)) is None


def test_matrix_with_coupling_is_recovered(tmp_path, still):
    rng = np.random.default_rng(1)
    A = rng.normal(size=(6, 6)) * np.sqrt(np.diag(still.robot.K_x)) * 0.2
    K = still.robot.K_x + A.T @ A
    truth = truth_of(still, np.linalg.inv(K))
    found = stiffness_matrix(pushes_of(tmp_path, still, truth))
    scale = np.sqrt(np.outer(np.diag(K), np.diag(K)))
    np.testing.assert_allclose(found / scale, K / scale, atol=2e-3)


def test_friction_is_told_apart_from_the_spring(tmp_path, scenario):
    """A hand feels 20 N, friction takes 3 of them, the law's spring gets 17: all three are told."""
    rough = scenario("openarm", timeline(("+x", "+y")))
    C = np.linalg.inv(rough.robot.K_x)
    summary = measured(tmp_path, rough, truth_of(rough, C, friction_N=3.0))
    asked = rough.robot.K_x[0, 0]
    assert summary.find("stiffness +x").value == pytest.approx(asked * 20 / 17, rel=1e-3)
    assert summary.find("stiffness +x").passed is None
    less = summary.find("stiffness +x less friction")
    assert less.value == pytest.approx(asked, rel=2e-3)
    assert "3 N" in less.note
    assert summary.find("offset after +x").value < 1e-6
    assert summary.passed


def test_friction_is_no_excuse_for_a_wrong_spring(tmp_path, scenario):
    rough = scenario("openarm", timeline(("+x", "+y")))
    C = np.linalg.inv(1.03 * rough.robot.K_x)
    assert not measured(tmp_path, rough, truth_of(rough, C, friction_N=3.0)).passed


@pytest.mark.parametrize(("friction_N", "passed"), [(0.5, True), (3.0, False)])
def test_with_dither_a_hand_feels_what_is_asked(tmp_path, scenario, friction_N, passed):
    """Judged is what is felt, to a tenth: that the spring is right is no excuse."""
    gains = "  - {at_s: 0.5, gains: {friction_compensation: dither}}"
    swinging = scenario("openarm", timeline(("+x", "+y"), gains))
    C = np.linalg.inv(swinging.robot.K_x)
    summary = measured(tmp_path, swinging, truth_of(swinging, C, friction_N=friction_N))
    felt = summary.find("stiffness +x")
    assert felt.value == pytest.approx(felt.expected * 20 / (20 - friction_N), rel=1e-3)
    assert felt.passed is passed
    assert summary.find("stiffness +x less friction").passed is None
    assert summary.passed is passed


def test_friction_band_is_what_the_joints_can_hold(scenario):
    """No pure tip force that friction can hold on every joint is outside the band (linear program),
    and friction that works against the push on every joint takes just the band.
    """
    rough = scenario("openarm", timeline(("+x",)))
    J = rough.robot.chain.jacobian(HOME)
    held = np.array([joint.friction for joint in rough.robot.joints])
    G = statics.tip_response(statics.CARTESIAN, J, rough.robot.K_x, np.ones(7))
    band = statics.greatest_friction_force(G, G @ J.T, np.eye(6)[0], held)
    force = linprog(
        [-1.0], A_ub=np.vstack([J[:1].T, -J[:1].T]), b_ub=np.tile(held, 2), bounds=(None, None)
    )
    assert -force.fun <= band * (1 + 1e-9)
    extreme = np.sign(np.eye(6)[0] @ G) * held
    assert statics.force_of_torque(G, G @ J.T, np.eye(6)[0], extreme) == pytest.approx(band)


def test_joint_pd_closed_form(tmp_path, scenario):
    """desktop2r: C = J K_q⁻¹ Jᵀ with the textbook Jacobian."""
    text = "friction: false\n" + timeline(
        ("+x", "+y"), "  - {at_s: 0.5, gains: {law: joint_pd, K_q_Nm_per_rad: [50, 30]}}"
    )
    arm = scenario("desktop2r", text)
    q1, q2, a1, a2 = 0.4, 1.1, 0.35, 0.3
    J = np.zeros((6, 2))
    J[0] = -a1 * np.sin(q1) - a2 * np.sin(q1 + q2), -a2 * np.sin(q1 + q2)
    J[1] = a1 * np.cos(q1) + a2 * np.cos(q1 + q2), a2 * np.cos(q1 + q2)
    J[5] = 1, 1
    C = J @ np.diag([1 / 50, 1 / 30]) @ J.T
    truth = truth_of(arm, C, np.array([q1, q2]))
    for i, push in enumerate(pushes_of(tmp_path, arm, truth)):
        assert push.expected == pytest.approx(1 / C[i, i], rel=1e-9)
        assert push.stiffness == pytest.approx(1 / C[i, i], rel=1e-3)
    assert measured(tmp_path, arm, truth).passed
    assert not measured(tmp_path, arm, truth_of(arm, 1.05 * C, np.array([q1, q2]))).passed


def test_planar_arm_gives_way_in_its_plane_only():
    """Two joints under K_x: J (Jᵀ K J)⁺ Jᵀ, which is K⁻¹ in the plane if K has no rotation."""
    J = np.zeros((6, 2))
    J[:2] = [[-0.3, -0.2], [0.4, 0.1]]
    J[5] = 1, 1
    K_x = np.diag([300.0, 300, 300, 0, 0, 0])
    C = statics.tip_response(statics.CARTESIAN, J, K_x, np.ones(2)) @ J.T
    np.testing.assert_allclose(C[:2, :2], np.eye(2) / 300, atol=1e-12)
    np.testing.assert_allclose(C[2], 0, atol=1e-12)


def test_gravity_compensation_holds_no_pose(tmp_path, scenario):
    text = timeline(("+x",), "  - {at_s: 0.5, gains: {law: gravity_compensation}}")
    free = scenario("openarm", text)
    assert pushes_of(tmp_path, free, truth_of(free, np.eye(6))) == []


def test_friction_force_of_one_joint():
    """A single hinge at distance r: friction τ takes the force τ / r."""
    J = np.array([[0.0], [0.4], [0], [0], [0], [1]])
    G = statics.tip_response(statics.JOINT, J, np.eye(6), np.array([30.0]))
    y = np.eye(6)[1]
    assert statics.greatest_friction_force(G, G @ J.T, y, np.array([0.2])) == pytest.approx(0.5)
    assert statics.force_of_torque(G, G @ J.T, y, np.array([-0.2])) == pytest.approx(-0.5)


@pytest.mark.parametrize("law", [statics.CARTESIAN, statics.JOINT])
def test_response_solves_the_balance_of_torques(law):
    """G (Jᵀ F + τ) is where a redundant arm under the law comes to rest, found by solving for q."""
    rng = np.random.default_rng(3)
    J, F = rng.normal(size=(6, 7)), rng.normal(size=6)
    K_x, K_q = np.diag(rng.uniform(10, 500, 6)), rng.uniform(10, 60, 7)
    # friction that leaves the arm's own motion alone, so that a rest exists under K_x alone
    torque = J.T @ rng.normal(size=6)
    stiffness = J.T @ K_x @ J if law == statics.CARTESIAN else np.diag(K_q)
    dq = np.linalg.lstsq(stiffness, J.T @ F + torque, rcond=1e-9)[0]
    G = statics.tip_response(law, J, K_x, K_q)
    np.testing.assert_allclose(G @ (J.T @ F + torque), J @ dq, rtol=1e-8)
    if law == statics.CARTESIAN:
        np.testing.assert_allclose(G @ J.T, np.linalg.inv(K_x), rtol=1e-7, atol=1e-12)


def test_springs_of_two_rods_under_a_wish_alike_in_x_and_y():
    """Jᵀ k J of a planar arm has k |p|² and k l₂² on its diagonal; its springs bound it."""
    q1, q2, a1, a2, k = 0.5, 1.0, 0.5, 0.4, 400.0
    p = np.array([a1 * np.cos(q1) + a2 * np.cos(q1 + q2), a1 * np.sin(q1) + a2 * np.sin(q1 + q2)])
    elbow = a2 * np.array([np.cos(q1 + q2), np.sin(q1 + q2)])
    J = np.zeros((6, 2))
    J[:2] = np.column_stack([[-p[1], p[0]], [-elbow[1], elbow[0]]])
    K_x = np.diag([k, k, k, 0, 0, 0])
    pairs = [SpringPair(400.0, 0.75)] * 2
    free = statics.springs_fitted(J, K_x, np.zeros(2), pairs)
    np.testing.assert_allclose(free, [k * p @ p, k * a2**2], rtol=1e-12)
    loaded = statics.springs_fitted(J, 0.01 * K_x, np.array([-8.0, 2.0]), pairs)
    np.testing.assert_allclose(loaded, [80.0, 40.0], rtol=1e-12)  # sqrt(2 * 400 * 8), of 2
    np.testing.assert_allclose(statics.springs_fitted(J, 9 * K_x, np.zeros(2), pairs)[0], 600.0)


def test_springs_response_solves_the_balance_with_the_weight():
    """Springs σ whose motors stand still, under the weight: rests found by solving for q."""
    robot = load_robot("antagonist2r")
    sigma, q_0, F = np.array([250.0, 70.0]), np.array([0.5, 1.0]), np.array([0.2, 0.1, 0, 0, 0, 0])
    weight = robot.dynamics.gravity_torque

    def out_of_balance(q):
        push = robot.chain.jacobian(q).T @ F
        return sigma * (q - q_0) + weight(q[None])[0] - weight(q_0[None])[0] - push

    q_1 = fsolve(out_of_balance, q_0, xtol=1e-12)
    moved = robot.chain.forward(q_1)[:2, 3] - robot.chain.forward(q_0)[:2, 3]
    J = robot.chain.jacobian((q_0 + q_1) / 2)
    G = statics.springs_response(J, sigma, robot.dynamics.gravity_slope((q_0 + q_1) / 2))
    np.testing.assert_allclose((G @ J.T @ F)[:2], moved, rtol=2e-3)


WALL = """friction: false
duration_s: 3
timeline:
  - {at_s: 0.5, wall: {point_m: [0.5, 0, 0], normal: [-1, 0, 0], stiffness_N_per_m: 20000}}
"""


def wall_truth(scenario, k: float) -> np.ndarray:
    """The tip arrives at 0.2 m/s at t = 1 s, overshoots, and rests 1 mm deep."""
    truth = truth_of(scenario, np.eye(6))
    t = truth["time_ns"] * 1e-9
    depth = np.where(t < 1, (t - 1) * 0.2, np.minimum(2e-3, 0.2 * (t - 1)))
    depth = np.where(t > 1.2, 1e-3, depth)
    truth["p_BT"] = 0.0
    truth["p_BT"][:, 0] = 0.5 + depth
    truth["V_BT"][:, 0] = np.where(t <= 1.01, 0.2, 0)
    truth["F_contact"][:, 0] = np.where(depth > 0, -k * depth, 0)
    truth["contact"] = depth > 0
    return truth


def test_wall(tmp_path, scenario):
    hit = scenario("openarm", WALL)
    summary = measured(tmp_path, hit, wall_truth(hit, 20000))
    assert summary.find("peak contact force").value == pytest.approx(40, rel=1e-6)
    assert summary.find("speed at contact").value == pytest.approx(0.2)
    assert summary.find("static contact force").value == pytest.approx(20, rel=1e-6)
    assert summary.passed
    assert not measured(tmp_path, hit, wall_truth(hit, 19000)).passed


def test_wall_that_was_not_reached(tmp_path, scenario):
    hit = scenario("openarm", WALL)
    summary = measured(tmp_path, hit, truth_of(hit, np.eye(6)))
    assert summary.find("wall touched").value is False


def test_refusals_losses_and_faults_fail_the_run(tmp_path, still):
    truth = truth_of(still, np.linalg.inv(still.robot.K_x))
    refused = np.zeros(16, int)
    refused[5] = 3
    summary = measured(tmp_path, still, truth, commands_refused=refused)
    assert summary.find("commands refused").value == 3
    assert "gate.STALE 3" in summary.find("commands refused").note
    assert not summary.passed

    faulty = state_of(truth)
    faulty["fault"][100:] = 3
    log = Log(write_log(tmp_path / "f.lcmlog", {"SIM_TRUTH": truth, "JOINT_STATE": faulty}))
    summary = measure(log, still, "lockstep")[0]
    assert summary.find("faults").value == "driver.REPLY_LOST"
    assert not summary.passed

    stopped = records("controller_status_t", 5, mode=6, reason=1)
    channels = {"SIM_TRUTH": truth, "JOINT_STATE": state_of(truth), "CONTROLLER_STATUS": stopped}
    summary = measure(Log(write_log(tmp_path / "c.lcmlog", channels)), still, "lockstep")[0]
    assert summary.find("faults").value == "controller.STATE_LOST"
    assert not summary.passed

    gap = np.delete(truth, slice(1000, 1004))
    log = Log(write_log(tmp_path / "g.lcmlog", {"SIM_TRUTH": gap, "JOINT_STATE": state_of(truth)}))
    summary = measure(log, still, "lockstep")[0]
    assert summary.find("messages lost").value == 4
    assert not summary.passed


@pytest.mark.parametrize(("dropped", "lost"), [(0, 3), (2, 3), (3, 3), (5, 5)])
def test_what_the_kernel_dropped_is_lost_on_all_channels_together(tmp_path, still, dropped, lost):
    """Gaps in numbers tell of numbered channels alone, and are among what was dropped."""
    truth = truth_of(still, np.linalg.inv(still.robot.K_x))
    log = Log(
        write_log(tmp_path / "d.lcmlog", {"SIM_TRUTH": truth, "JOINT_STATE": state_of(truth)})
    )
    summary = measure(log, still, "lockstep", {"JOINT_STATE": 3}, recorder_dropped=dropped)[0]
    assert summary.find("messages lost").value == lost
    more = "2 more before the recorder" in summary.find("messages lost").note
    assert more == (dropped == 5)
    assert not summary.passed


def test_not_a_number_never_passes(tmp_path, still):
    truth = truth_of(still, np.linalg.inv(still.robot.K_x))
    truth["p_BT"] = np.nan
    summary = measured(tmp_path, still, truth)
    assert summary.find("messages with impossible numbers").passed is False
    assert not summary.passed


def test_summary_file(tmp_path, still):
    import json

    summary = measured(tmp_path, still, truth_of(still, np.linalg.inv(still.robot.K_x)))
    summary.save(tmp_path / "summary.json")
    content = json.loads((tmp_path / "summary.json").read_text())
    assert content["pass"] is True
    assert content["robot"] == "openarm"
    first = next(r for r in content["results"] if r["name"] == "stiffness +x")
    assert set(first) >= {"name", "value", "unit", "expected", "tolerance", "pass"}
    assert first["unit"] == "N/m"


def test_with_friction_observed_a_hand_is_promised_the_spring(tmp_path, scenario):
    """Torque sensors leave the bearings' friction: between no and twice its bound, of the push."""
    gains = "{law: cartesian_impedance, friction_compensation: observer, friction_share: 1}"
    arm = scenario("iiwa14", timeline(("+x",), f"  - {{at_s: 0.5, gains: {gains}}}"))
    home = arm.robot.home
    J = arm.robot.chain.jacobian(home)
    bearings = np.array([joint.link_friction for joint in arm.robot.joints])
    G = J @ np.linalg.pinv(J.T @ arm.robot.K_x @ J, rcond=1e-9)
    x = np.eye(6)[0]
    bound = np.abs(x @ G) @ bearings * statics.stiffness_along(G @ J.T, x)
    assert 0.1 < bound < 3.0, "a few tenths of a newton metre at less than a metre"
    asked = 1 / (G @ J.T)[0, 0]
    for held, good in ((0.0, True), (1.9 * bound, True), (2.6 * bound, False)):
        C = np.linalg.inv(arm.robot.K_x) * (20 - held) / 20
        found = measured(tmp_path, arm, truth_of(arm, C, home)).find("stiffness +x")
        assert found.value == pytest.approx(asked * 20 / (20 - held), rel=1e-3)
        assert found.passed is good
