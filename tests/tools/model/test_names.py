"""Names are judged where they are read, by the rule of common/names.h."""

import pytest

from limber.errors import InputError
from limber.model.robot import load_robot
from limber.model.scenario import load_scenario
from limber.paths import ROOT

BAD = ["../..", "a/b", "<script>", "x" * 300, "a\nb", " a", ".a", "é"]


@pytest.fixture
def robot(tmp_path):
    def named(name: str):
        source = ROOT / "robots" / "desktop2r"
        text = (source / "robot.yaml").read_text()
        quoted = name.replace("\n", "\\n")
        (tmp_path / "robot.yaml").write_text(
            text.replace("name: desktop2r", f'name: "{quoted}"', 1)
        )
        (tmp_path / "robot.urdf").write_bytes((source / "robot.urdf").read_bytes())
        return str(tmp_path)

    return named


@pytest.mark.parametrize("name", BAD)
def test_a_robots_name(robot, name):
    folder = robot(name)
    with pytest.raises(InputError, match=r"robot.yaml:3: name: ") as refused:
        load_robot(folder)
    assert str(refused.value).count("robot.yaml") == 1, "once"


@pytest.mark.parametrize("name", ["openarm", "my arm", "a.b-c_d", "2r", "x" * 64])
def test_good_names(robot, name):
    folder = robot(name)
    assert load_robot(folder).name == name


@pytest.mark.parametrize("name", BAD[:3])
def test_a_scenarios_name(name, tmp_path):
    path = tmp_path / "s.yaml"
    path.write_text(f'format: limber-scenario/1\nname: "{name}"\nrobot: desktop2r\nduration_s: 1\n')
    with pytest.raises(InputError, match=r"s.yaml:2: name: ") as refused:
        load_scenario(path)
    assert str(refused.value).count("s.yaml") == 1, "once"
