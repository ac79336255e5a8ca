"""What to change in robot.yaml, with file and line."""

from pathlib import Path

import pytest

from limber.errors import InputError
from limber.joint_check.judge import Finding, Verdict
from limber.joint_check.wiring import change_words, changes, explanation, read_keys

TEXT = """\
buses: [{name: left, can: "virtual:l"}, {name: right, can: "virtual:r"}]
joints:
  lift:
    motor: big
    bus: left
    id: 0x01
    sign: -1
  swing: {motor: big, bus: left, id: 2, reply_id: 18}
  wrist:
    motor: small
    bus: right
    id: 2
"""
NAMES = ["lift", "swing", "wrist"]


@pytest.fixture
def keys(tmp_path: Path):
    path = tmp_path / "robot.yaml"
    path.write_text(TEXT, encoding="utf-8")
    return read_keys(path, NAMES)


def found(keys, joint, verdict, moved, other, way=1):
    finding = Finding(verdict, moved, (other,))
    told = [change_words(change) for change in changes(keys, joint, way, finding)]
    return told, explanation(keys, joint, finding)


def test_a_sign_that_is_there_and_one_that_is_not(keys):
    told, text = found(keys, 0, Verdict.SIGN, -0.2, 0)
    assert told == ["joints.lift.sign: 1 instead of -1 (robot.yaml:7)"]
    assert "its sign is wrong" in text
    told, _ = found(keys, 2, Verdict.SIGN, -0.2, 2)
    assert told == ["joints.wrist.sign: -1, a new key (robot.yaml:9)"]


def test_exchanged_motors_name_both_keys(keys):
    told, text = found(keys, 1, Verdict.EXCHANGED, 0.2, 0)
    assert "joints.swing.id (line 8) and joints.lift.id (line 6)" in text
    assert told[0] == "joints.swing.id: 0x01 instead of 2 (robot.yaml:8)"


def test_the_sign_belongs_to_the_motor_that_moved(keys):
    """lift has -1. What its reading did as asked, or not, is what its sign is to be at swing."""
    as_asked, _ = found(keys, 1, Verdict.EXCHANGED, 0.2, 0)
    assert as_asked[1:] == ["joints.swing.sign: -1, a new key (robot.yaml:8)"]
    against, _ = found(keys, 1, Verdict.EXCHANGED, -0.2, 0)
    assert against[1:] == []
    the_other_direction, _ = found(keys, 1, Verdict.EXCHANGED, -0.2, 0, way=-1)
    assert the_other_direction == as_asked


def test_what_differs_goes_along(keys):
    told, _ = found(keys, 2, Verdict.EXCHANGED, 0.2, 1)
    assert told == [
        "joints.wrist.motor: big instead of small (robot.yaml:10)",
        "joints.wrist.bus: left instead of right (robot.yaml:11)",
        "joints.wrist.reply_id: 18, a new key (robot.yaml:9)",
    ]


@pytest.mark.parametrize("verdict", [Verdict.OK, Verdict.SEVERAL, Verdict.LINK])
def test_nothing_to_change(keys, verdict):
    assert changes(keys, 0, 1, Finding(verdict, 0.2, (0, 1))) == []


def test_several_are_named(keys):
    text = explanation(keys, 0, Finding(Verdict.SEVERAL, 0.2, (2, 0)))
    assert text == "lift, wrist moved at once: hold the others and turn lift alone."


def test_a_links_encoder_is_set_in_the_drive(keys):
    text = explanation(keys, 0, Finding(Verdict.LINK, 0.2, (0,)))
    assert "lift's motor moved, but the encoder on its link by another angle" in text
    assert "Its direction is set in the drive" in text


def test_a_missing_joint(tmp_path):
    (tmp_path / "robot.yaml").write_text(TEXT, encoding="utf-8")
    with pytest.raises(InputError, match=r"joints\.elbow is missing"):
        read_keys(tmp_path / "robot.yaml", ["elbow"])


def test_of_an_empty_file_the_joint_is_named(tmp_path):
    (tmp_path / "robot.yaml").write_text("")
    with pytest.raises(InputError, match=r"joints\.lift is missing"):
        read_keys(tmp_path / "robot.yaml", NAMES)
