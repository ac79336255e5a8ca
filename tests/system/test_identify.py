"""Arms that differ from what robot.yaml says, run in the lab: identification finds what is hidden.

Each true value lies within a few standard errors of what is found, or within a share of it where
the standard error knows less than the share.
"""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml

from limber.identify import excitation, friction, gravity, payload, stiffness, torque_constant
from limber.identify.arm import Arm, load_arm
from limber.identify.motion import Motion, read_motion
from limber.identify.static_poses import static_poses
from limber.identify.urdf_edit import with_inertials
from stack import BIN, ROOT

pytestmark = pytest.mark.lockstep

CONSTANT = "rotor_torque_constant_Nm_per_A"
STANDARD_ERRORS = 4.0
SLOW_PART_S = 25.0  # of a tour of three poses


def record(
    folder: Path, robot: Path, tour: dict, spread: float, poses: int, seconds: float = np.inf
) -> Path:
    """The log of a tour, or of its first seconds, with `tour` added to the scenario."""
    arm = load_arm(str(robot))
    scenario = yaml.safe_load(excitation.scenario_text(arm, str(robot), spread, poses, seed=3))
    scenario["timeline"] += tour.pop("timeline", [])
    scenario["timeline"] = [entry for entry in scenario["timeline"] if entry["at_s"] < seconds]
    scenario["duration_s"] = min(scenario["duration_s"], seconds)
    path, log = folder / "tour.yaml", folder / "run.lcmlog"
    path.write_text(yaml.safe_dump(scenario | tour, sort_keys=False), encoding="utf-8")
    command = [str(BIN / "limber-lab"), str(path), "--log", str(log)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return log


def numbers(module, arm: Arm, motion: Motion) -> dict[tuple[str, str], tuple[float, float]]:
    """Joint and key of robot.yaml -> value and standard error."""
    found = module.identify(arm, motion)
    return {(v.joint, v.name): (v.value, v.std) for v in found.values}


def agrees(found: tuple[float, float], truth: float, share: float) -> bool:
    value, std = found
    assert std < 0.1 * truth, (value, std, "is no measurement")
    return abs(value - truth) <= max(STANDARD_ERRORS * std, share * truth)


@pytest.fixture(scope="module")
def bench(tmp_path_factory) -> tuple[Arm, Motion]:
    """One elastic joint under gravity."""
    folder = tmp_path_factory.mktemp("bench")
    robot = Path(shutil.copytree(ROOT / "robots" / "testbench", folder / "testbench"))
    text = (robot / "robot.yaml").read_text(encoding="utf-8")
    heavy = text.replace("gravity_m_per_s2: [0, 0, 0]", "gravity_m_per_s2: [0, -20, 0]")
    assert heavy != text
    (robot / "robot.yaml").write_text(heavy, encoding="utf-8")
    plant_overrides = {
        "motors": {"bench": {CONSTANT: 0.8}},
        "joints": {
            "joint": {
                "transmission": {"spring": {"stiffness_Nm_per_rad": 4000}},
                "friction": {"coulomb_Nm": 2, "viscous_Nms_per_rad": 1},
                "link_friction": {"coulomb_Nm": 0.3, "viscous_Nms_per_rad": 0.2},
                "torque_sensor": {"noise_Nm": 0.1, "resolution_Nm": 0.02, "bias_Nm": 0.4},
            }
        },
    }
    log = record(folder, robot, {"plant_overrides": plant_overrides}, spread=1.2, poses=3)
    arm = load_arm(str(robot))
    return arm, read_motion([log], arm)


def test_bench(bench):
    arm, motion = bench
    assert agrees(numbers(torque_constant, arm, motion)["joint", CONSTANT], 0.8, 0.002)
    name = "stiffness_Nm_per_rad"
    assert agrees(numbers(stiffness, arm, motion)["joint", name], 4000.0, 0.001)
    found = numbers(friction, arm, motion)
    for side, coulomb, viscous in (("friction", 2.0, 1.0), ("link_friction", 0.3, 0.2)):
        assert agrees(found["joint", f"{side}: coulomb_Nm"], coulomb, 0.01)
        assert agrees(found["joint", f"{side}: viscous_Nms_per_rad"], viscous, 0.02)


def test_bias_of_the_torque_sensor(bench):
    arm, motion = bench
    found = gravity.identify(arm, motion)
    bias = next(value for value in found.values if value.name == "torque at no load")
    assert bias.value == pytest.approx(0.4, abs=STANDARD_ERRORS * bias.std) and bias.std < 0.05


def test_seven_flexible_joints(tmp_path):
    """Four numbers are hidden in an iiwa14, the others must stay what they are."""
    robot = ROOT / "robots" / "iiwa14"
    coulomb = {"coulomb_Nm": 15, "static_Nm": 18, "stribeck_rad_per_s": 0.08}
    plant_overrides = {
        "motors": {"shoulder": {CONSTANT: 0.09}},
        "joints": {
            "joint_1": {"friction": coulomb},
            "joint_4": {
                "transmission": {"spring": {"stiffness_Nm_per_rad": 8000}},
                "link_friction": {"coulomb_Nm": 0.4},
            },
        },
    }
    log = record(tmp_path, robot, {"plant_overrides": plant_overrides}, spread=0.6, poses=2)
    arm = load_arm(str(robot))
    motion = read_motion([log], arm)
    constants = numbers(torque_constant, arm, motion)
    for (name, _), value in constants.items():
        joint = next(joint for joint in arm.joints if joint.name == name)
        truth = 0.09 if joint.motor == "shoulder" else joint.motor_values[CONSTANT]
        assert agrees(value, truth, 0.02), name
    assert len(constants) >= 5
    springs = numbers(stiffness, arm, motion)
    for (name, key), value in springs.items():
        joint = next(joint for joint in arm.joints if joint.name == name)
        truth = 8000.0 if name == "joint_4" else joint.believed("transmission", "spring", key)
        assert agrees(value, truth, 0.005), name
    found = numbers(friction, arm, motion)
    assert agrees(found["joint_1", "friction: coulomb_Nm"], 15.0, 0.02)
    assert agrees(found["joint_1", "friction: static_Nm"], 18.0, 0.02)
    assert agrees(found["joint_2", "friction: coulomb_Nm"], 12.0, 0.02)
    assert agrees(found["joint_4", "link_friction: coulomb_Nm"], 0.4, 0.03)


def test_springs_of_two_motors(tmp_path):
    """Their torque is known from the weight of the links only."""
    robot = ROOT / "robots" / "antagonist2r"
    spring = {"transmission": {"spring": {"k2_Nm_per_rad2": 330}}}
    tour = {"plant_overrides": {"joints": {"shoulder": spring}}}
    log = record(tmp_path, robot, tour, spread=0.6, poses=2)
    arm = load_arm(str(robot))
    found = numbers(stiffness, arm, read_motion([log], arm))
    assert agrees(found["shoulder", "k2_Nm_per_rad2"], 330.0, 0.005)
    assert agrees(found["elbow", "k2_Nm_per_rad2"], 400.0, 0.005)


def test_heavier_links_of_a_series_elastic_arm(tmp_path):
    """The URDF that is proposed pulls at the joints as the arm that was hidden does."""
    robot = Path(shutil.copytree(ROOT / "robots" / "baxter", tmp_path / "baxter"))
    arm = load_arm(str(robot))
    inertials = arm.robot.inertials
    changes = {}
    for i, body in enumerate(arm.robot.dynamics.bodies):
        link = inertials[body.heaviest]
        changes[body.heaviest] = (link.mass * (1.0 + 0.05 * i), link.com + 0.01)
    (robot / "heavier.urdf").write_text(with_inertials(arm.robot.urdf, changes))
    tour = {"plant_overrides": {"urdf": "heavier.urdf"}}
    log = record(tmp_path, robot, tour, spread=0.8, poses=4, seconds=32.0)
    proposed = gravity.identify(arm, read_motion([log], arm)).inertials
    (robot / "proposed.urdf").write_text(with_inertials(arm.robot.urdf, proposed))
    q = excitation.poses(arm, 0.7, 20, seed=8)  # others than in the tour
    torques = {}
    for name in ("robot", "heavier", "proposed"):
        text = (robot / "robot.yaml").read_text(encoding="utf-8")
        (robot / "robot.yaml").write_text(
            text.replace(f"urdf: {arm.robot.urdf.name}", f"urdf: {name}.urdf"), encoding="utf-8"
        )
        torques[name] = load_arm(str(robot)).robot.dynamics.gravity_torque(q)
        (robot / "robot.yaml").write_text(text, encoding="utf-8")
    off = np.abs(torques["robot"] - torques["heavier"]).max(axis=0)
    left = np.abs(torques["proposed"] - torques["heavier"]).max(axis=0)
    assert off.max() > 2.0
    assert np.all(left < np.maximum(0.12 * off, 0.15)), (off, left)


def test_payload(tmp_path):
    carried = {"mass_kg": 0.8, "position_m": [0.02, -0.03, 0.07]}
    tour = {"timeline": [{"at_s": 0.0, "payload": carried}]}
    robot = ROOT / "robots" / "openarm"
    log = record(tmp_path, robot, tour, spread=0.8, poses=3, seconds=SLOW_PART_S)
    arm = load_arm(str(robot))
    found = static_poses([log], arm.robot.dynamics)
    said = payload.identify(arm.robot.chain, found.q, found.tau, arm.robot.gravity)
    assert abs(said.mass_kg - 0.8) < STANDARD_ERRORS * said.mass_std < 0.2
    off = np.abs(said.com_m - carried["position_m"])
    assert np.all(off < STANDARD_ERRORS * said.com_std) and np.all(said.com_std < 0.02)


def test_all_in_one_go_takes_the_sag_away(tmp_path):
    """Rods heavier than their URDF: the tour, the proposal, and the tour once more with it, the
    simulated arm being what it was. Without friction nothing but weights makes the arm sag.
    """
    robot = Path(shutil.copytree(ROOT / "robots" / "planar2r", tmp_path / "planar2r"))
    arm = load_arm(str(robot))
    inertials = arm.robot.inertials
    links = [body.heaviest for body in arm.robot.dynamics.bodies]
    heavier = {name: (1.2 * inertials[name].mass, 1.05 * inertials[name].com) for name in links}
    (robot / "heavier.urdf").write_text(with_inertials(arm.robot.urdf, heavier))
    scenario = yaml.safe_load(excitation.scenario_text(arm, "planar2r", 0.8, 5, seed=3))
    tour = scenario | {"mode": "lockstep", "plant_overrides": {"urdf": "heavier.urdf"}}
    (tmp_path / "tour.yaml").write_text(yaml.safe_dump(tour, sort_keys=False))
    command = [sys.executable, "-m", "limber", "identify", "arm", str(tmp_path / "tour.yaml")]
    command += ["--out", str(tmp_path / "out")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    said = " ".join(done.stdout.split())
    before, after = re.search(r"rms: ([\d.]+) mm before, ([\d.]+) mm with", said).groups()
    assert float(before) > 20.0 and float(after) < 0.05 * float(before), said
