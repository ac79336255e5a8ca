"""A sweep from a scenario: keys found, files collected, refusals in the reader's words."""

import shutil

import pytest
import yaml

from limber import __version__
from limber.errors import InputError
from limber.paths import robots_root
from limber.sweep.definition import SCENARIO, define, load
from limber.sweep.keys import put

TEXT = """format: limber-scenario/1
robot: {robot}
duration_s: 3
timeline:
  - {{at_s: 1.0, gains: {{law: cartesian_impedance, K_x_translation_N_per_m: 300}}}}
  - {{at_s: 1.2, push: {{force_N: [5, 0, 0], for_s: 0.5}}}}
  - {{at_s: 2.0, push: {{force_N: [0, 5, 0], for_s: 0.5}}}}
"""


@pytest.fixture
def scenario(tmp_path):
    path = tmp_path / "first.yaml"
    path.write_text(TEXT.format(robot="desktop2r"), encoding="utf-8")
    return path


def defined(scenario, *vary, method="lhs", runs=10):
    return define(scenario, list(vary), method, runs, 1, 0.2)


def changed(key, value, joints=None):
    content = yaml.safe_load(TEXT.format(robot="desktop2r"))
    put(content, key, value, joints or {})
    return content


def test_places_of_keys():
    assert changed("seed", 5)["seed"] == 5
    assert changed("wire.loss", 0.1)["wire"] == {"loss": 0.1}
    assert changed("gains.ramp_s", 1)["timeline"][0]["gains"]["ramp_s"] == 1
    assert changed("timeline.2.push.force_N.1", 7)["timeline"][2]["push"]["force_N"] == [0, 7, 0]
    assert changed("payload.mass_kg", 2)["timeline"][3] == {"at_s": 0, "payload": {"mass_kg": 2}}
    content = changed("seed", 5)
    content["timeline"].append({"at_s": 2.5, "gains": {"ramp_s": 1}})
    put(content, "gains.ramp_s", 2, {})
    assert content["timeline"][3]["gains"] == {"ramp_s": 2}, "the one that has it"
    joints = {"one": {"friction": {}}, "two": {}, "three": {"friction": {}}}
    key = "plant_overrides.joints.*.friction.coulomb_Nm"
    found = changed(key, 0.5, joints)["plant_overrides"]["joints"]
    assert found == {name: {"friction": {"coulomb_Nm": 0.5}} for name in ("one", "three")}


WRONG = [
    ("sead=1..5", "did you mean 'seed'"),
    ("seed=1..5.5", "found '5.5'; expected a whole number"),
    ("bus_delay=0..0.01", "wire.delay_s: is 0.01; on bus arm at 1000 Hz a cycle has room for"),
    ("wire.loss=0..2", "'2.0' is out of range; expected a number from 0 to 1"),
    ("gains.K_q=1..2", "did you mean 'K_q_Nm_per_rad'"),
    ("gains.law=cartesian_impedance,soft", "found 'soft'; expected one of"),
    ("push.for_s=1..2", "expected timeline.1.push.for_s, timeline.2.push.for_s"),
    ("goal.duration_s=1..2", "the timeline has no entry goal"),
    ("timeline.3.push.for_s=1..2", "'3' is no place in a list; expected 0 to 2"),
    ("delay=0..0.001", "no joint in robot.yaml has link_encoder"),
    ("step_s=0.0001..0.00017", "a whole number of steps must make the control period"),
    ("seed=2.5,3", "found '2.5'; expected a whole number"),
    ("seed=1,2 seed=3,4", "expected once a key"),
]


@pytest.mark.parametrize(("vary", "said"), WRONG)
def test_refusals(scenario, vary, said):
    with pytest.raises(InputError) as refused:
        defined(scenario, *vary.split())
    assert str(refused.value).startswith("--vary") and said in str(refused.value)
    assert "limber-sweep-" not in str(refused.value), "no file that is gone"


def test_the_scenarios_reader_decides_what_is_whole(scenario):
    vary = defined(scenario, "seed=1..5", "duration_s=2..4").vary
    assert [variation.how for variation in vary] == ["whole", ""]


def test_a_run_has_its_values_and_a_seed_whatever_else_is_done(scenario):
    sweep = defined(scenario, "gains.K_x=100..500", "payload_kg=0,1")
    runs = dict(sweep.each(set()))
    assert list(runs) == list(range(10)) and len({run["seed"] for run in runs.values()}) == 10
    assert dict(sweep.each({0, 1, 2, 3, 5})) == {run: runs[run] for run in (4, 6, 7, 8, 9)}
    content = yaml.safe_load(sweep.files_of(runs[4])[SCENARIO])
    assert content["seed"] == runs[4]["seed"] and content["robot"] == "desktop2r"
    gains = content["timeline"][0]["gains"]
    assert gains["K_x_translation_N_per_m"] == runs[4]["gains.K_x_translation_N_per_m"]
    assert "seed" in dict(defined(scenario, "seed=7,8").each(set()))[0]
    assert {values["seed"] for _, values in defined(scenario, "seed=7,8").each(set())} == {7, 8}


def test_the_robot_travels_with_the_scenario(scenario, tmp_path):
    files = defined(scenario, "seed=1..5").files
    assert sorted(files) == ["desktop2r/robot.urdf", "desktop2r/robot.yaml", SCENARIO]
    shutil.copytree(robots_root() / "desktop2r", tmp_path / "arms" / "mine")
    scenario.write_text(TEXT.format(robot="arms/mine"), encoding="utf-8")
    files = defined(scenario, "seed=1..5").files
    assert sorted(files) == ["mine/robot.urdf", "mine/robot.yaml", SCENARIO]
    content = yaml.safe_load(files[SCENARIO])
    assert (content["robot"], content["name"]) == ("mine", "first")


def test_another_sweep_is_refused_by_name(scenario, tmp_path):
    out = tmp_path / "sweep"
    out.mkdir()
    sweep = defined(scenario, "gains.K_x=100..500", "friction=true,false")
    sweep.save(out)
    sweep.refuse_another(out)
    assert load(out) == sweep
    with pytest.raises(InputError, match=r"another sweep: runs: 10 there, 11 here"):
        defined(scenario, "gains.K_x=100..500", "friction=true,false", runs=11).refuse_another(out)
    with pytest.raises(InputError, match=r"vary: .*=100\.\.500.* there, .*=100\.\.600.* here"):
        defined(scenario, "gains.K_x=100..600", "friction=true,false").refuse_another(out)
    kept = (out / "sweep.json").read_text(encoding="utf-8")
    (out / "sweep.json").write_text(kept.replace('"limber": "', '"limber": "9.'), encoding="utf-8")
    with pytest.raises(InputError, match=f"'limber': '9.{__version__}'.* there, .*'{__version__}'"):
        load(out)
    (out / "sweep.json").write_text(kept, encoding="utf-8")
    (out / "scenario" / SCENARIO).write_text(TEXT.format(robot="desktop2r"), encoding="utf-8")
    with pytest.raises(InputError, match=r"another sweep: files: .*scenario\.yaml"):
        load(out)
