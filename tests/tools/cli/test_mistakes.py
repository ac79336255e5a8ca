"""Slips of a person who writes a scenario or a robot.yaml: each is told, with file, line and what
is right. What is typed on the command line is in test_cli.py.
"""

import shutil
import subprocess

import pytest

from limber.paths import program, robots_root

SCENARIO = """format: limber-scenario/1
robot: openarm
duration_s: 4
timeline:
  - {at_s: 0.3, mode: hold}
  - {at_s: 0.8, mode: active}
  - {at_s: 1.0, gains: {law: cartesian_impedance, K_x_translation_N_per_m: 500}}
  - {at_s: 1.5, push: {force_N: [0, 8, 0], ramp_s: 0.2, for_s: 1}}
  - {at_s: 2.0, goal: {offset_m: [0.05, 0, 0], duration_s: 1}}
"""
LAW, K_X = "law: cartesian_impedance", "K_x_translation_N_per_m: 500"
GOAL, PUSH = "offset_m: [0.05, 0, 0]", "push: {force_N: [0, 8, 0], ramp_s: 0.2, for_s: 1}"
HEAD = "duration_s: 4"

# what is written, what is written instead, the line of the complaint, what it has to hold
IN_SCENARIOS = [
    ("format: limber-scenario/1\n", "", 1, "'format' is missing"),
    ("limber-scenario/1", "limber-scenario/9", 1, "expected one of: limber-scenario/1"),
    (f"{HEAD}\n", "", 1, "'duration_s' is missing"),
    (HEAD, "duration: 4", 1, "is 'duration' a slip?"),
    (HEAD, "duration_s: four", 3, "'four' is not a number"),
    (HEAD, "duration_s: -4", 3, "out of range; expected a number from 0.01"),
    (HEAD, f"{HEAD}\nduration_s: 5", 4, "'duration_s' is here twice; first on line 3"),
    (HEAD, f"{HEAD}\nfriction: off_please", 4, "expected true or false"),
    (HEAD, f"{HEAD}\nmode: real-time", 4, "did you mean 'realtime'?"),
    (HEAD, f"{HEAD}\nintegrator: rk4", 4, "expected one of: ode, reference"),
    (HEAD, f"{HEAD}\nseed: 1.5", 4, "expected a whole number"),
    (HEAD, f"{HEAD}\nstart_q: [0, 0]", 4, "found 2 entries; expected a list of 7"),
    ("robot: openarm", "robot: open_arm", 2, "did you mean 'openarm'?"),
    ("robot: openarm\n", "", 1, "'robot' is missing"),
    ("timeline:", "timline:", 4, "did you mean 'timeline'?"),
    ("  - {at_s: 1.5", "\t- {at_s: 1.5", 8, "holds a tab"),
    ("mode: active", "mode: actve", 6, "did you mean 'active'?"),
    ("mode: active", "mode: on", 6, "expected one of: idle, hold, active"),
    (", mode: active", "", 6, "exactly one of: mode, gains, goal"),
    ("mode: active", f"mode: active, {PUSH}", 6, "found mode, push"),
    (LAW, "law: cartesian", 7, "did you mean 'cartesian_impedance'?"),
    (LAW, "law: impedance", 7, "expected one of: gravity_compensation"),
    (K_X, "K_x_translation: 500", 7, "did you mean 'K_x_translation_N_per_m'?"),
    (K_X, "stiffness: 500", 7, "unknown key 'stiffness'"),
    (K_X, "K_x_translation_N_per_m: -500", 7, "expected a number from 0 to 100000"),
    (K_X, "K_x_translation_N_per_m: 5e6", 7, "expected a number from 0 to 100000"),
    (K_X, "K_x_translation_N_per_m: 500 N/m", 7, "'500 N/m' is not a number"),
    (K_X, "K_x_translation_N_per_m: [500, 500]", 7, "expected a list of 3 numbers"),
    (K_X, "damping_ratio: 30", 7, "expected a number from 0 to 2"),
    (K_X, "K_q_Nm_per_rad: [1, 2, 3]", 7, "expected a list of 7 numbers"),
    (K_X, "M_x: 3", 7, "expected 6 lists of 6 numbers"),
    ("force_N", "force", 8, "'force_N' or 'torque_Nm' is missing"),
    ("[0, 8, 0]", "8", 8, "expected a list of 3 numbers"),
    ("[0, 8, 0]", "[0, 8000, 0]", 8, "expected a number from -200 to 200"),
    ("for_s: 1", "for: 1", 8, "is 'for' a slip?"),
    ("push: {force_N", "push: {link: hand, force_N", 8, "expected one of: link0"),
    (PUSH, "fault: {joint: joint9, kind: silent}", 8, "expected one of: joint1"),
    (PUSH, "fault: {joint: joint1, kind: dead}", 8, "expected one of: silent"),
    (
        PUSH,
        "wall: {point_m: [0, 0, 0], normal: [0, 0, 0], stiffness_N_per_m: 9}",
        8,
        "expected 1",
    ),
    (GOAL, "offset: [0.05, 0, 0]", 9, "did you mean 'offset_m'?"),
    (GOAL, "offset_m: [50, 0, 0]", 9, "expected a number from -10 to 10"),
    (GOAL, "offset_m: [0.05, 0]", 9, "expected a list of 3 numbers"),
    (GOAL, "position_m: [0.4, 0, 0.4]", 9, "'quaternion_wxyz' is missing"),
    (GOAL, "joints_rad: [0, 0]", 9, "expected a list of 7 numbers"),
    ("at_s: 2.0", "at_s: 20", 9, "expected a number from 0 to 4"),
    ("at_s: 2.0, goal", "at: 2.0, goal", 9, "is 'at' a slip?"),
    ("goal:", "gaol:", 9, "did you mean 'goal'?"),
]

# What can be read but will be refused when its time comes, or does not do what it looks like.
FORETOLD = [
    (GOAL, "joints_rad: [0.3, 0.3, 0, 1.4, 0, 0, 0]", "goal at 2 s", "pose goals, not joint goals"),
    (GOAL, "offset_m: [2, 0, 0]", "goal at 2 s", "reach"),
    ("at_s: 2.0, goal", "at_s: 0.5, goal", "goal at 0.5 s", "in ACTIVE only"),
    (LAW, "law: admittance", "gains at 1 s", "contact source"),
    (LAW, "law: tomei", "gains at 1 s", "elastic joint"),
    (LAW, "law: variable_stiffness", "gains at 1 s", "two motors"),
    (f"{LAW}, {K_X}", "law: joint_pd, K_q_Nm_per_rad: 9000", "gains at 1 s", "is stable at"),
]

IN_ROBOTS = [
    ("format: limber-robot/1", "format: limber-robot/2", "expected one of: limber-robot/1"),
    ("rate_hz: 1000", "rate: 1000", "is 'rate' a slip?"),
    ("rate_hz: 1000", "rate_hz: 100000", "expected a number from 10 to 10000"),
    ("urdf: robot.urdf", "urdf: arm.urdf", "no file 'arm.urdf'"),
    ("base: ", "basis: ", "is 'basis' a slip?"),
    ("tip: link8", "tip: hand", "no link 'hand'; there are: link0"),
    ("bitrate_bps: 1000000", "bitrate_bps: 1M", "expected a whole number from 10000"),
    ('can: "virtual:', 'can: "usb:', "expected virtual:NAME, socketcan:INTERFACE, slcan:/dev/NAME"),
    ("protocol: damiao_mit", "protocol: damaio", "expected one of: damiao_mit, moteus, cia402"),
    ("gear_ratio", "gear", "is 'gear' a slip?"),
    ("watchdog:", "watchdogs:", "is 'watchdogs' a slip?"),
    ("timeout_s: ", "timeout_ms: ", "is 'timeout_ms' a slip?"),
    ("reaction: damp", "reaction: brake", "expected one of: damp, off"),
    ("    id: 1\n", "    id: 2\n", "2 is taken by joint1 on the same bus"),
    ("bus: arm", "bus: leg", "found 'leg'; expected one of: arm"),
    ("K_x_translation_N_per_m:", "K_x_translation:", "is 'K_x_translation' a slip?"),
    ("damping_ratio: 0.7", "damping_ratio: 7", "expected a number from 0 to 2"),
    ("home_rad:", "home:", "is 'home' a slip?"),
    ("coulomb_Nm: 0", "coulomb_Nm: -0", "expected a number from 0 to 1000"),
    ("K_q_Nm_per_rad: [", "K_q_Nm_per_rad: [1, ", "found 8 entries; expected a list of 7"),
]


def check(*arguments) -> tuple[int, str]:
    command = [program("limber-check"), *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=30)
    return done.returncode, done.stdout + done.stderr


def changed(text: str, before: str, after: str) -> str:
    assert before in text
    return text.replace(before, after, 1)


def test_the_scenario_before_the_slips_is_right(tmp_path):
    (tmp_path / "good.yaml").write_text(SCENARIO)
    code, told = check("scenario", tmp_path / "good.yaml")
    assert code == 0 and "warning" not in told


@pytest.mark.parametrize(("before", "after", "line", "told"), IN_SCENARIOS)
def test_slips_in_a_scenario(tmp_path, before, after, line, told):
    path = tmp_path / "slip.yaml"
    path.write_text(changed(SCENARIO, before, after))
    code, said = check("scenario", path)
    assert code == 2
    assert f"slip.yaml:{line}: " in said
    assert told in said


@pytest.mark.parametrize(("before", "after", "which", "why"), FORETOLD)
def test_what_will_be_refused_is_foretold(tmp_path, before, after, which, why):
    path = tmp_path / "slip.yaml"
    path.write_text(changed(SCENARIO, before, after))
    code, said = check("scenario", path)
    warned = [line for line in said.splitlines() if "warning" in line]
    assert code == 0
    assert any(which in line and why in line for line in warned), said


@pytest.mark.parametrize(("before", "after", "told"), IN_ROBOTS)
def test_slips_in_a_robot(tmp_path, before, after, told):
    folder = tmp_path / "arm"
    shutil.copytree(robots_root() / "openarm", folder)
    path = folder / "robot.yaml"
    path.write_text(changed(path.read_text(), before, after))
    code, said = check("robot", folder)
    assert code == 2
    assert f"{folder}/robot." in said, "the file is named"
    assert told in said
