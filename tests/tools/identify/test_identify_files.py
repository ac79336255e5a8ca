"""What identification writes: edited YAML and URDF, and the motion it asks for."""

import numpy as np
import pytest
import yaml

from limber.errors import InputError
from limber.identify.arm import JointBelief, load_arm
from limber.identify.excitation import poses, reach, scenario_text
from limber.identify.urdf_edit import with_inertials
from limber.identify.yaml_edit import fragment, set_number
from limber.model.robot import load_robot

TEXT = """# an arm
motors:
  big: # the big one
    gear_ratio: 9 # datasheet
    constant: 0.14   # drive; not measured
joints:
  a: {motor: big, friction: {coulomb_Nm: 1}} # guessed
  b:
    motor: big

# the end
gains: 3
"""


def edited(path: tuple[str, ...], value: str) -> str:
    text = set_number(TEXT, path, value)
    tree = yaml.safe_load(TEXT)
    level = tree
    for key in path[:-1]:
        level = level.setdefault(key, {})
    level[path[-1]] = yaml.safe_load(value)
    assert yaml.safe_load(text) == tree
    return text


def test_a_number_is_replaced_and_its_source_kept():
    text = edited(("motors", "big", "constant"), "0.15")
    assert "    constant: 0.15 # identified; before: drive; not measured\n" in text
    changed = set(text.splitlines()) ^ set(TEXT.splitlines())
    assert len(changed) == 2, "one line, out and in"


def test_numbers_in_braces():
    text = edited(("joints", "a", "friction", "coulomb_Nm"), "2")
    assert "friction: {coulomb_Nm: 2}} # identified; before: guessed" in text
    text = set_number(text, ("joints", "a", "friction", "viscous"), "3.5")
    assert "{coulomb_Nm: 2, viscous: 3.5}} # identified; before: guessed" in text


def test_new_keys_go_where_their_mapping_ends():
    text = edited(("joints", "b", "friction", "coulomb_Nm"), "2")
    assert "    motor: big\n    friction: {coulomb_Nm: 2} # identified\n\n# the end" in text
    edited(("motors", "big", "resistance"), "2")
    edited(("weights",), "2")


def test_a_mapping_is_no_number():
    with pytest.raises(InputError, match="not what was expected"):
        set_number(TEXT, ("motors", "big"), "1")


def test_fragment():
    text = fragment({("a", "b"): 1.5, ("a", "c", "d"): 2})
    assert yaml.safe_load(text) == {"a": {"b": 1.5, "c": {"d": 2}}}


def test_urdf_keeps_all_but_the_inertial():
    robot = load_robot("openarm")
    urdf, before = robot.urdf, robot.inertials
    text = with_inertials(urdf, {"link3": (1.25, np.array([0.01, -0.02, 0.03]))})
    lines, canon = text.splitlines(), with_inertials(urdf, {}).splitlines()
    assert 1 <= sum(a != b for a, b in zip(lines, canon, strict=True)) <= 3
    path = urdf.parent / "robot.urdf"
    assert path.read_text() != text and "link3" in before


def test_the_motion_stays_within_limits_and_uses_its_range():
    arm = load_arm("openarm")
    tour = poses(arm, 0.6, 5, seed=2)
    for i, info in enumerate(arm.robot.joints):
        assert tour[:, i].min() >= info.low and tour[:, i].max() <= info.high
        assert len(np.unique(tour[:, i])) == 5
    inner = np.array([j.high - j.low for j in arm.robot.joints]) > 1.4
    assert np.all(np.ptp(tour, axis=0)[inner] > 0.6)


def test_reach_of_the_tip():
    """Both rods stretched out and turned from -x over +y to +x."""
    arm = load_arm("planar2r")
    tour = np.array([[np.pi, 0.0], [0.0, 0.0]])
    arm.__dict__["home"] = tour[0]
    low, high = reach(arm, tour)
    length = high[0]
    assert length == pytest.approx(np.linalg.norm(arm.robot.chain.forward(tour[1])[:3, 3]))
    np.testing.assert_allclose(low, [-length, 0.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(high, [length, length, 0.0], rtol=0.01)


def test_there_and_back():
    arm = load_arm("planar2r")
    content = yaml.safe_load(scenario_text(arm, "planar2r", 0.5, 4, seed=1))
    goals = [e["goal"]["joints_rad"] for e in content["timeline"] if "goal" in e]
    slow, fast = goals[:8], goals[8:16]
    assert slow == fast and slow[:3] == slow[4:7][::-1] and slow[-1] == list(arm.robot.home)
    assert content["duration_s"] > max(e["at_s"] for e in content["timeline"])


@pytest.mark.parametrize(
    ("rotary", "linear"),
    [
        ("coulomb_Nm", "coulomb_N"),
        ("viscous_Nms_per_rad", "viscous_Ns_per_m"),
        ("stribeck_rad_per_s", "stribeck_m_per_s"),
        ("stiffness_Nm_per_rad", "stiffness_N_per_m"),
        ("k2_Nm_per_rad2", "k2_N_per_m2"),
        ("home_rad", "home_m"),
    ],
)
def test_keys_of_sliding_joints(rotary, linear):
    """As robots/joint_chain_yaml.cc names them."""
    assert JointBelief("j", "m", False, {}, {}).key(rotary) == rotary
    assert JointBelief("j", "m", True, {}, {}).key(rotary) == linear
