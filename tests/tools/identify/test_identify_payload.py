"""A payload is found again from the torques its weight makes; poor poses are refused."""

import numpy as np
import pytest
from made_logs import records, write_log

from limber import messages
from limber.errors import InputError
from limber.identify.arm import load_arm
from limber.identify.payload import identify
from limber.identify.static_poses import static_poses
from limber.model.robot import load_robot

MASS, COM = 0.8, np.array([0.02, -0.03, 0.07])
RATE_HZ = 100


@pytest.fixture(scope="module")
def robot():
    return load_robot("openarm")


@pytest.fixture(scope="module")
def poses() -> np.ndarray:
    return np.random.default_rng(3).uniform(-1.5, 1.5, (8, 7))


def potential(robot, q: np.ndarray) -> float:
    X_BT = robot.chain.forward(q)
    return -MASS * robot.gravity @ (X_BT[:3, 3] + X_BT[:3, :3] @ COM)


def weight(robot, poses: np.ndarray) -> np.ndarray:
    """What holds the payload: the derivative of its potential energy."""
    h = 1e-6
    steps = h * np.eye(7)
    rows = [[potential(robot, q + s) - potential(robot, q - s) for s in steps] for q in poses]
    return np.array(rows) / (2 * h)


def test_exact_torques_give_the_payload_back(robot, poses):
    found = identify(robot.chain, poses, weight(robot, poses), robot.gravity)
    assert found.mass_kg == pytest.approx(MASS, abs=1e-7)
    np.testing.assert_allclose(found.com_m, COM, atol=1e-7)
    assert found.residual_rms < 1e-7


def test_offsets_are_told_from_weight(robot, poses):
    offsets = np.linspace(-0.5, 0.5, 7)
    tau = weight(robot, poses) + offsets
    found = identify(robot.chain, poses, tau, robot.gravity, offsets=True)
    assert found.mass_kg == pytest.approx(MASS, abs=1e-6)
    np.testing.assert_allclose(found.offsets, offsets, atol=1e-6)
    assert identify(robot.chain, poses, tau, robot.gravity).residual_rms > 0.1


def test_standard_deviations_are_those_of_repeated_experiments(robot, poses):
    rng = np.random.default_rng(4)
    exact = weight(robot, poses)
    runs = [
        identify(robot.chain, poses, exact + rng.normal(0, 0.05, exact.shape), robot.gravity)
        for _ in range(400)
    ]
    stated = np.sqrt(np.mean([run.mass_std**2 for run in runs]))
    assert np.std([run.mass_kg for run in runs]) == pytest.approx(stated, rel=0.12)
    stated = np.sqrt(np.mean([run.com_std**2 for run in runs], axis=0))
    np.testing.assert_allclose(np.std([run.com_m for run in runs], axis=0), stated, rtol=0.15)


def test_refuses_what_tells_too_little(robot, poses):
    tau = weight(robot, poses)
    with pytest.raises(InputError, match="2 static poses; at least 3"):
        identify(robot.chain, poses[:2], tau[:2], robot.gravity)
    with pytest.raises(InputError, match="at least 4"):
        identify(robot.chain, poses[:3], tau[:3], robot.gravity, offsets=True)
    same = np.repeat(poses[:1], 5, axis=0)
    with pytest.raises(InputError, match="condition number"):
        identify(robot.chain, same, weight(robot, same), robot.gravity, offsets=True)
    with pytest.raises(InputError, match="no payload"):
        noise = np.random.default_rng(1).normal(0, 0.05, tau.shape)
        identify(robot.chain, poses, noise, robot.gravity)


def write_run(path, poses: np.ndarray, tau: np.ndarray, seconds: float = 1.0):
    """Lies in a stand for a second, then rests in each pose for `seconds`, with half a second of
    motion between.
    """
    modes = messages.message_class("controller_status_t")
    still, moving = int(seconds * RATE_HZ), RATE_HZ // 2
    q, torque = [np.tile(poses[0] + 0.2, (RATE_HZ, 1))], [np.full((RATE_HZ, 7), 99.0)]
    for i, pose in enumerate(poses):
        follower = poses[min(i + 1, len(poses) - 1)]
        way = np.linspace(0, 1, moving)[:, None]
        q += [np.tile(pose, (still, 1)), pose + way * (follower - pose + 0.1)]
        torque += [np.tile(tau[i], (still, 1)), np.full((moving, 7), 99.0)]
    q, torque = np.vstack(q), np.vstack(torque)
    count = len(q)
    time_ns = np.arange(count) * (10**9 // RATE_HZ)
    state = records("joint_state_t", count, time_ns=time_ns, num_joints=7)
    state["q"][:, :7] = q
    state["tau_applied"][:, :7] = torque + load_arm("openarm").robot.dynamics.gravity_torque(q)
    status = records("controller_status_t", count, time_ns=time_ns, num_joints=7)
    status["state_seq"], status["mode"] = np.arange(count), modes.MODE_HOLD
    return write_log(path, {"JOINT_STATE": state, "CONTROLLER_STATUS": status})


def test_command_reads_the_poses_of_a_run(robot, poses, tmp_path, limber):
    path = write_run(tmp_path / "run.lcmlog", poses, weight(robot, poses))
    found = static_poses([path], load_arm("openarm").robot.dynamics)
    assert len(found.q) == len(poses)
    np.testing.assert_allclose(found.q, poses, atol=1e-9)
    result = limber("identify", "payload", str(path), "--robot", "openarm")
    assert result.returncode == 0, result.stderr
    assert "0.8000" in result.stdout
    assert "8 poses" in result.stdout
    assert (tmp_path / "identify" / "payload.png").stat().st_size > 10_000


def test_a_run_without_rest_is_refused(robot, poses, tmp_path, limber):
    path = write_run(tmp_path / "run.lcmlog", poses, weight(robot, poses), seconds=0.1)
    result = limber("identify", "payload", str(path), "--robot", "openarm")
    assert result.returncode == 2
    assert "stand still" in result.stderr
