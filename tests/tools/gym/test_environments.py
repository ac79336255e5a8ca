"""The environments of limber.gym: Gymnasium's own checker, seeds, modes, faults, and tasks that can
be done.
"""

import warnings

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium")

from gymnasium.utils.env_checker import check_env  # noqa: E402

import limber.gym  # noqa: E402
from limber.errors import InputError, RunError  # noqa: E402
from limber.gym.actions import CONTROL_MODES, LEASH_M, RATIOS  # noqa: E402
from limber.live import request_messages  # noqa: E402
from limber.messages import message_class  # noqa: E402

NAMES = ("Reach", "Push", "Peg")


def made(name: str, **more):
    return getattr(limber.gym, name)(**more)


def rolled(env, seed: int, steps: int, actions_seed: int = 7) -> list:
    """Observations, rewards and flags of random actions."""
    rng = np.random.default_rng(actions_seed)
    low, high = env.action_space.low, env.action_space.high
    kept = [env.reset(seed=seed)[0]]
    for _ in range(steps):
        kept.append(env.step(rng.uniform(low, high).astype(np.float32)))
    return kept


def in_bytes(kept: list) -> list:
    def flat(value):
        if isinstance(value, dict):
            return {key: flat(each) for key, each in value.items()}
        if isinstance(value, tuple):
            return [flat(each) for each in value]
        return value.tobytes() if isinstance(value, np.ndarray) else value

    return [flat(value) for value in kept]


@pytest.mark.parametrize("name", NAMES)
def test_gymnasiums_checker_finds_nothing(name):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        env = gymnasium.make(f"limber.gym:limber/{name}-v0")
        check_env(env.unwrapped)
        env.close()


@pytest.mark.parametrize("name", NAMES)
def test_equal_seeds_give_equal_bytes_and_others_do_not(name):
    env = made(name, friction_scale=(0.5, 1.5), payload_kg=(0.0, 0.5))
    first = in_bytes(rolled(env, 3, 20))
    assert in_bytes(rolled(env, 3, 20)) == first, "the same environment again"
    assert in_bytes(
        rolled(made(name, friction_scale=(0.5, 1.5), payload_kg=(0.0, 0.5)), 3, 20)
    ) == (first)
    assert in_bytes(rolled(env, 4, 0)) != first[:1]


@pytest.mark.parametrize("impedance_mode", ["fixed", "variable_kp", "variable"])
@pytest.mark.parametrize("control_mode", CONTROL_MODES)
def test_every_mode_runs_and_what_it_asks_is_taken(control_mode, impedance_mode):
    env = made("Reach", control_mode=control_mode, impedance_mode=impedance_mode)
    env.reset(seed=1)
    rng = np.random.default_rng(2)
    middle = 0.5 * (env.action_space.low + env.action_space.high)
    for _ in range(20):
        away = 0.2 * rng.uniform(-1.0, 1.0, middle.shape) * (env.action_space.high - middle)
        if control_mode == "pd_joint_pos":
            away[-7:] += (env.robot.home - middle[-7:]).astype(np.float32)
        observation, _, _, _, info = env.step(middle + away)
        assert (info["refused"], info["fault"]) == ("", "")
        assert env.observation_space.contains(observation)


def test_the_impedance_of_an_action_becomes_the_arms():
    env = made("Reach", impedance_mode="variable")
    env.reset(seed=1)
    K = [300.0, 400.0, 500.0, 10.0, 12.0, 14.0]
    assert env.action_space.low[0] == pytest.approx(RATIOS[0])
    np.testing.assert_allclose(env.action_space.low[1:7], 0.2 * np.diag(env.robot.K_x))
    np.testing.assert_allclose(env.action_space.high[1:7], 2.0 * np.diag(env.robot.K_x))
    for _ in range(4):
        env.step(np.array([0.9, *K, *np.zeros(6)]))
    status = env.lab.message("CONTROLLER_STATUS")
    np.testing.assert_allclose(np.diag(status["K_x"]), K, rtol=1e-6)


def test_a_softer_arm_gives_way_further_to_the_same_push():
    moved = []
    for scale in (0.4, 1.6):
        env = made("Reach", robot="ideal7", impedance_mode="variable_kp", start_spread_rad=0.0)
        env.reset(seed=1)
        action = np.array([*scale * np.diag(env.robot.K_x), *np.zeros(6)])
        for _ in range(10):
            env.step(action)
        start = env.lab.message("SIM_TRUTH")["p_BT"].copy()
        env.lab.send(request_messages.push([0.0, 5.0, 0.0], None, 3.0, 0.2, "", 1))
        for _ in range(30):
            env.step(action)
        moved.append(env.lab.message("SIM_TRUTH")["p_BT"][1] - start[1])
    assert moved[0] / moved[1] == pytest.approx(4.0, rel=0.1)


def test_target_modes_count_from_the_goal_the_others_from_the_arm():
    """Against a push the goal of the one stays where it was, that of the other goes along."""
    shifts = {}
    for mode in ("pd_ee_target_delta_pose", "pd_ee_delta_pose"):
        env = made("Reach", control_mode=mode)
        env.reset(seed=1)
        start = env.lab.message("CONTROLLER_STATUS")["p_BD"].copy()
        env.lab.send(request_messages.push([0.0, 15.0, 0.0], None, 30.0, 0.2, "", 1))
        for _ in range(40):
            env.step(np.zeros(6))
        shifts[mode] = env.lab.message("CONTROLLER_STATUS")["p_BD"][1] - start[1]
    assert abs(shifts["pd_ee_target_delta_pose"]) < 1e-3
    assert shifts["pd_ee_delta_pose"] > 0.05


def test_goals_are_smooth_and_do_not_run_away_from_the_arm():
    env = made("Reach")
    env.reset(seed=1)
    lab = env.lab
    speeds = []
    for _ in range(40):
        env.step(np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0]))
        status = lab.message("CONTROLLER_STATUS")
        assert np.linalg.norm(status["p_BD"] - status["p_BT"]) < LEASH_M + 0.03
    env.reset(seed=1)
    env.lab.send(env.actions.target(env._goal, 0.05))
    last = env.lab.message("CONTROLLER_STATUS")["p_BD"].copy()
    for k in range(10):
        goal = env.actions.goal(np.array([float(k % 3 == 0), 0, 0, 0, 0, 0]), env._at(), env._goal)
        env.lab.send(env.actions.target(goal, 0.05))
        env._goal = goal
        for _ in range(50):
            env.lab.step(1)
            p = env.lab.message("CONTROLLER_STATUS")["p_BD"].copy()
            speeds.append((p - last) / 1e-3)
            last = p
        env._read()
    jumps = np.abs(np.diff(speeds, axis=0)).max()
    assert jumps < 0.02 + 1e-3 * 10.0, "10 m/s² is the most that a stream's goal gets"


def test_a_fault_ends_the_episode():
    env = made("Reach")
    env.reset(seed=1)
    event = message_class("scenario_event_t")()
    event.kind, event.fault, event.joint = event.EVENT_FAULT, event.FAULT_DRIVE_ERROR, 2
    event.normal = [0.0, 0.0, 1.0]
    env.lab.send(event)
    _, _, terminated, _, info = env.step(np.zeros(6))
    assert terminated and info["fault"] == "DRIVE_ERROR"


def toward(observation) -> np.ndarray:
    away = observation["environment_state"][:3] - observation["tip"][:3]
    return np.array([*0.5 * np.clip(50.0 * away, -1.0, 1.0), 0.0, 0.0, 0.0])


def into_the_hole(observation) -> np.ndarray:
    mouth, axis = np.split(observation["environment_state"], 2)
    from_mouth = observation["tip"][:3] - mouth
    along = from_mouth @ axis
    aside = from_mouth - along * axis
    deeper = 0.2 if np.linalg.norm(aside) < 0.004 or along > -0.005 else 0.0
    return np.array([*np.clip(deeper * axis - 25.0 * aside, -1.0, 1.0), 0.0, 0.0, 0.0])


def behind_the_block(observation) -> np.ndarray:
    block, place = observation["environment_state"][:2], observation["environment_state"][3:]
    ahead = (place - block) / np.linalg.norm(place - block)
    side = np.array([-ahead[1], ahead[0]])
    off = (observation["tip"][:2] - block) @ side
    return np.array([*np.clip(0.25 * ahead - 25.0 * off * side, -1.0, 1.0), *np.zeros(4)])


@pytest.mark.parametrize(
    ("name", "policy"),
    [("Reach", toward), ("Peg", into_the_hole), ("Push", behind_the_block)],
)
def test_the_task_can_be_done(name, policy):
    env = gymnasium.make(f"limber/{name}-v0")
    for seed in range(5):
        observation, _ = env.reset(seed=seed)
        ended = False
        while not ended:
            observation, reward, terminated, truncated, info = env.step(policy(observation))
            ended = terminated or truncated
        assert info["success"] and info["fault"] == "", (name, seed)
        assert reward > 0.9
    env.close()


def test_a_peg_beside_the_hole_stays_outside():
    """Without a look for the hole the plate holds the peg, by the spring's force."""
    env = made("Peg", offset_m=0.0, friction=0.0)
    env.reset(seed=1)
    env._mouth = env._mouth + 0.02 * np.linalg.svd(env._axis[None])[2][1]
    env.place_plate()
    for k in range(40):
        env.step(np.array([*(0.3 if k < 15 else 0.0) * env._axis, 0.0, 0.0, 0.0]))
    truth = env.lab.message("SIM_TRUTH")
    along = env._axis @ (truth["p_BT"] - env._mouth)
    assert truth["contact"] == 1
    assert -env._radius_m <= along < -env._radius_m + 0.003
    pressed = -env._axis @ truth["F_contact"][:3]
    assert 5.0 < pressed == pytest.approx(2e4 * (along + env._radius_m), rel=0.05)


@pytest.mark.parametrize("vectorization_mode", ["sync", "async"])
def test_vectors_of_environments_are_the_single_ones(vectorization_mode):
    alone = []
    actions = np.random.default_rng(5).uniform(-1.0, 1.0, (10, 2, 6)).astype(np.float32)
    for k in range(2):
        env = gymnasium.make("limber/Reach-v0")
        alone.append([env.reset(seed=20 + k)[0], *(env.step(each[k])[0] for each in actions)])
        env.close()
    envs = gymnasium.make_vec(
        "limber.gym:limber/Reach-v0", num_envs=2, vectorization_mode=vectorization_mode
    )
    seen = [envs.reset(seed=20)[0], *(envs.step(each)[0] for each in actions)]
    envs.close()
    for k in range(2):
        for one, both in zip(alone[k], seen, strict=True):
            for key, value in one.items():
                np.testing.assert_array_equal(both[key][k], value)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"control_mode": "pd_ee_pose"}, "pd_ee_delta_pose"),
        ({"impedance_mode": "soft"}, "variable_kp"),
        ({"control_hz": 0.0}, "control_hz"),
        ({"friction_scale": (2.0, 1.0)}, "friction_scale"),
        ({"payload_kg": (0.0, float("nan"))}, "payload_kg"),
        ({"render_mode": "human"}, "render_mode"),
        ({"robot": "no_such"}, "no robot 'no_such'"),
    ],
)
def test_wrong_arguments_are_told(given, words):
    with pytest.raises(InputError, match=words):
        made("Reach", **given)


def test_wrong_actions_are_told():
    env = made("Reach")
    with pytest.raises(RunError, match="reset"):
        env.step(np.zeros(6))
    env.reset(seed=1)
    for action in (np.zeros(5), np.full(6, np.nan)):
        with pytest.raises(InputError, match="6 finite numbers"):
            env.step(action)
