"""Numbers hidden in a simulated joint are found again; logs that cannot tell are refused."""

import shutil
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import yaml
from two_mass_joint import BELIEVED, CONSTANT, LEVER, MASS, Friction, Truth, run, tour

from limber.errors import InputError
from limber.identify import commands, friction, gravity, stiffness, torque_constant
from limber.identify.arm import load_arm
from limber.identify.motion import motion_of, read_motion
from limber.identify.recording import read_logs
from limber.identify.regression import PoorLogError, fit, ratio

HIDDEN = Truth(
    kappa=0.85,
    friction=Friction(5.0, 7.5, 0.08, 8.0),
    link_friction=Friction(0.3, 0.3, 0.1, 0.4),
)


@pytest.fixture(scope="module")
def flexible(tmp_path_factory):
    """Both encoders and a torque sensor."""
    return run(tmp_path_factory.mktemp("flexible"), HIDDEN, BELIEVED)


@pytest.fixture(scope="module")
def rigid(tmp_path_factory):
    """The motor's encoder, and nothing else."""
    truth = replace(HIDDEN, rigid=True, motor_bits=14)
    return run(tmp_path_factory.mktemp("rigid"), truth, BELIEVED)


WEIGHED = 0.001  # share to which the pendulum's mass is known, where it is


def found_in(folder, module, *weights: float) -> dict[str, tuple[float, float]]:
    arm = load_arm(str(folder))
    findings = module.identify(arm, read_motion([folder], arm), *weights)
    findings.require_something()
    return {value.name: (value.value, value.std) for value in findings.values}


def agrees(found: tuple[float, float], truth: float, share: float) -> bool:
    """Within a share of the truth, with a standard error that is no excuse for more."""
    value, std = found
    return abs(value - truth) < share * truth and std < share * truth


@pytest.mark.parametrize("kind", ["flexible", "rigid"])
def test_torque_constant(kind, request):
    found = found_in(request.getfixturevalue(kind), torque_constant, WEIGHED)
    assert agrees(found["rotor_torque_constant_Nm_per_A"], 0.85 * CONSTANT, 0.005)


@pytest.mark.parametrize("kind", ["flexible", "rigid"])
def test_friction_of_the_motor(kind, request):
    """In true torque although the drive believes in another torque constant."""
    found = found_in(request.getfixturevalue(kind), friction, WEIGHED)
    assert agrees(found["friction: coulomb_Nm"], 5.0, 0.01)
    assert agrees(found["friction: viscous_Nms_per_rad"], 8.0, 0.01)
    assert agrees(found["friction: static_Nm"], 7.5, 0.02)
    assert agrees(found["friction: stribeck_rad_per_s"], 0.08, 0.05)


def test_friction_of_the_link_is_told_apart_by_a_torque_sensor(flexible, rigid):
    found = found_in(flexible, friction)
    assert agrees(found["link_friction: coulomb_Nm"], 0.3, 0.05)
    assert agrees(found["link_friction: viscous_Nms_per_rad"], 0.4, 0.05)
    assert not any(name.startswith("link") for name in found_in(rigid, friction))


@pytest.mark.parametrize(("kind", "taken_off"), [("rigid", 1.5), ("flexible", 0.0)])
def test_friction_of_the_link_is_not_proposed_for_the_motor(kind, taken_off, request, tmp_path):
    """Without a torque sensor only the sum of both shows."""
    folder = shutil.copytree(request.getfixturevalue(kind), tmp_path / "run")
    text = (folder / "robot.yaml").read_text()
    link = "    link_friction: {coulomb_Nm: 1.5, viscous_Nms_per_rad: 0}\n"
    (folder / "robot.yaml").write_text(text.replace("gains:", link + "gains:"))
    arm = load_arm(str(folder))
    values = friction.identify(arm, read_motion([folder], arm)).values
    coulomb = next(value for value in values if value.name == "friction: coulomb_Nm")
    assert coulomb.value - coulomb.proposed == pytest.approx(taken_off)


def test_stiffness(flexible):
    found = found_in(flexible, stiffness)
    assert agrees(found["stiffness_Nm_per_rad"], 3000.0, 0.001)


def test_weight(tmp_path):
    """The moment about the axis is what gravity shows; the mass itself stays as it was."""
    truth = replace(HIDDEN, kappa=1.0, weight=1.15)
    found = found_in(run(tmp_path, truth, BELIEVED), gravity)
    mass, centre = found["mass of link"], found["centre of link, y"]
    assert mass[0] * centre[0] == pytest.approx(-1.15 * MASS * LEVER, rel=2e-3)
    assert mass[1] > 0.2 * MASS, "nothing in this log tells it"
    assert found["centre of link, x"][0] == pytest.approx(0.0, abs=2e-3)


@pytest.fixture(scope="module")
def poor_run(tmp_path_factory):
    """A run along a path, made once."""

    @cache
    def make(path, rigid: bool):
        return run(tmp_path_factory.mktemp("poor"), replace(Truth(), rigid=rigid), BELIEVED, path())

    return make


def still() -> np.ndarray:
    return np.zeros((30_000, 2))


def one_way() -> np.ndarray:
    return np.vstack([tour([-1.0, 1.0], 8.0, 0.0), np.tile([1.0, 0.0], (5000, 1))])


def nearly_still() -> np.ndarray:
    """Back and forth where gravity hardly changes."""
    return tour([0.0, 0.01] * 16 + [0.0], 0.6, 0.1)


@pytest.mark.parametrize(
    ("module", "path", "reason"),
    [
        (torque_constant, still, "does not move"),
        (friction, still, "does not move"),
        (gravity, still, "moves too little"),
        (stiffness, still, "bends the spring too little"),
        (torque_constant, one_way, "one direction only"),
        (friction, one_way, "one direction only"),
        (torque_constant, nearly_still, "gravity changes its load by only"),
        (gravity, nearly_still, "change its torque by only"),
    ],
)
def test_a_log_that_cannot_tell_is_refused(module, path, reason, poor_run):
    folder = poor_run(path, rigid=module is not stiffness)
    with pytest.raises(InputError, match=reason):
        found_in(folder, module)


def test_missing_sensors_are_said(rigid):
    with pytest.raises(InputError, match="transmission is rigid"):
        found_in(rigid, stiffness)


def test_standard_errors_are_those_of_repeated_experiments():
    """Noise that stays for a while, as friction and cogging do, is no independent witness."""
    rng = np.random.default_rng(5)
    count, block = 2000, np.arange(2000) // 25
    A = np.stack([np.sin(np.arange(count) / 40.0), np.ones(count)], axis=1)
    fits = []
    for _ in range(300):
        noise = np.convolve(rng.normal(0, 1, count + 9), np.ones(10), mode="valid")
        fits.append(fit(A, A @ [2.0, 4.0] + noise, block))
    stated = np.sqrt(np.mean([f.covariance for f in fits], axis=0).diagonal())
    np.testing.assert_allclose(np.std([f.x for f in fits], axis=0), stated, rtol=0.15)
    ratios = np.array([ratio(f, (0, 1), 1) for f in fits])
    assert ratios[:, 0].mean() == pytest.approx(1.5, abs=0.01)
    assert np.std(ratios[:, 0]) == pytest.approx(np.sqrt(np.mean(ratios[:, 1] ** 2)), rel=0.15)


def test_what_cannot_be_told_apart_is_refused():
    x = np.linspace(1.0, 2.0, 500)
    with pytest.raises(PoorLogError, match="too uniform"):
        fit(np.stack([x, 2.0 * x], axis=1), x, np.arange(500) // 25)
    with pytest.raises(PoorLogError, match="too little motion"):
        fit(np.stack([x, x**2], axis=1), x, np.arange(500) // 250)


def test_command_proposes_and_leaves_the_robot_alone(flexible, limber, tmp_path):
    before = (flexible / "robot.yaml").read_text()
    out = tmp_path / "out"
    done = limber("identify", "stiffness", str(flexible), "--out", str(out))
    assert done.returncode == 0, done.stderr
    assert "3000" in done.stdout and "4000" in done.stdout
    assert (flexible / "robot.yaml").read_text() == before
    assert (out / "stiffness.png").stat().st_size > 10_000
    merged = (out / "stiffness.robot.yaml").read_text()
    assert "# identified; before: guessed" in merged
    number = (out / "stiffness.yaml").read_text().split(":")[-1].strip()
    assert float(number) == pytest.approx(3000, rel=1e-3)
    changed = [line for line in (out / "stiffness.diff").read_text().splitlines() if line[0] == "+"]
    assert len(changed) == 2 and number in changed[1]


@pytest.fixture(scope="module")
def heavier(tmp_path_factory):
    """The pendulum weighs 15 % more than its URDF says."""
    return run(
        tmp_path_factory.mktemp("heavier"), replace(HIDDEN, kappa=1.0, weight=1.15), BELIEVED
    )


def test_gravity_command_proposes_a_urdf(heavier, limber, tmp_path):
    done = limber("identify", "gravity", str(heavier), "--out", str(tmp_path))
    assert done.returncode == 0, done.stderr
    assert '<link name="flange"' in (tmp_path / "gravity.robot.urdf").read_text()
    assert (tmp_path / "gravity.diff").read_text().startswith("--- ")
    assert (tmp_path / "gravity.png").is_file()


def test_a_urdf_that_is_right_stays(flexible, limber, tmp_path):
    done = limber("identify", "gravity", str(flexible), "--out", str(tmp_path))
    assert done.returncode == 0, done.stderr
    assert "no other is proposed" in done.stdout
    assert not (tmp_path / "gravity.robot.urdf").exists()


def test_a_constant_rests_on_weights(rigid, tmp_path):
    """Without a torque sensor: refused as long as the weights are a guess, and if they are claimed
    to be known and are not.
    """
    with pytest.raises(InputError, match=r"known to 30%.*identify gravity first"):
        found_in(rigid, torque_constant)
    own = found_in(rigid, friction)
    assert agrees(own["friction: coulomb_Nm"], 5.0 / 0.85, 0.01), "in the drive's own N m"


def test_all_in_one_go(heavier, limber, tmp_path):
    """Weights, constant, friction and spring of one log, as a robot folder, beside the log."""
    recorded = shutil.copytree(heavier, tmp_path / "run")
    done = limber("identify", "arm", str(recorded))
    assert done.returncode == 0, done.stderr
    proposed = recorded / "identify" / "robot"
    assert {path.name for path in proposed.iterdir()} == {"robot.yaml", "robot.urdf"}
    robot = yaml.safe_load((proposed / "robot.yaml").read_text())
    joint = robot["joints"]["j1"]
    assert joint["transmission"]["spring"]["stiffness_Nm_per_rad"] == pytest.approx(3000, rel=2e-3)
    assert joint["friction"]["coulomb_Nm"] == pytest.approx(5.0, rel=0.02)
    body = load_arm(str(proposed)).robot.dynamics.bodies[0]
    assert body.moment[1] == pytest.approx(-1.15 * MASS * LEVER, rel=3e-3)
    again = limber("identify", "arm", str(recorded))
    assert again.returncode == 2 and "exists" in again.stderr


def test_encoders_that_answer_late(flexible):
    """A link encoder 2 ms behind the motor's: it is told, and the stiffness stays right."""
    arm = load_arm(str(flexible))
    recording = read_logs([flexible], arm)[0]
    late = np.vstack([recording.q[:1]] * 2 + [recording.q[:-2]])
    found = stiffness.identify(arm, motion_of([replace(recording, q=late)])).values
    assert found[0].value == pytest.approx(3000.0, rel=2e-3)
    assert found[1].value == pytest.approx(2e-3, rel=0.02)


def test_what_a_motion_lacks_is_said(tmp_path):
    """Fast all the time, and never slow."""
    path = tour([0.0] + [1.2, -1.2] * 12 + [0.0], 0.6, 0.0)
    folder = run(tmp_path, replace(HIDDEN, kappa=1.0), BELIEVED, path)
    arm = load_arm(str(folder))
    motion = read_motion([folder], arm)
    fast = replace(motion, moving=motion.moving & (np.abs(motion.theta_dot) > 0.5))
    assert any("slower than 0.1 rad/s" in note for note in friction.identify(arm, fast).notes)


def test_commands_refuse_in_one_line(tmp_path, limber, poor_run):
    folder = shutil.copytree(poor_run(still, rigid=True), tmp_path / "run")
    done = limber("identify", "friction", str(folder))
    assert done.returncode == 2
    assert "does not move" in done.stderr and "Traceback" not in done.stderr
    with pytest.raises(InputError, match="the log has 1 joints"):
        read_motion([folder], commands.arm_of([folder], "openarm"))
    (folder / "robot.yaml").unlink()
    with pytest.raises(InputError, match="--robot"):
        commands.arm_of([folder], None)
