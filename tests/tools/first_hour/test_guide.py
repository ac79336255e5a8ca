"""What is kept between two calls, and what is done again."""

import json
import shutil

import pytest
from rich.console import Console

from limber.errors import OK, OUT_OF_TOLERANCE, InputError
from limber.first_hour import guide
from limber.first_hour.guide import Step
from limber.first_hour.record import FAILED, PASSED, Found, Record, failed
from limber.model.robot import load_robot
from limber.paths import robot_folder


@pytest.fixture
def arm(tmp_path):
    return shutil.copytree(robot_folder("desktop2r"), tmp_path / "arm")


@pytest.fixture
def guided(arm, tmp_path, monkeypatch):
    """Steps whose verdicts the test chooses; returns which were done, and the exit code."""
    verdicts = {"wire": PASSED, "zero": PASSED, "push": PASSED}
    done: list[str] = []

    def step(name: str) -> Step:
        def check(*_) -> Found:
            done.append(name)
            return Found(PASSED, ("fine",)) if verdicts[name] == PASSED else failed("no", "mend it")

        return Step(name, "", check)

    monkeypatch.setattr(guide, "STEPS", tuple(map(step, verdicts)))
    monkeypatch.setattr(guide, "NAMES", tuple(verdicts))
    monkeypatch.setattr(guide.network, "ensure_multicast", lambda _: None)

    def call(begin: str | None = None, **changed: str) -> tuple[list[str], int]:
        verdicts.update(changed)
        done.clear()
        code = guide.run(str(arm), tmp_path / "out", begin, Console(quiet=True))
        return list(done), code

    return call


def test_it_stops_at_what_fails_and_goes_on_from_there(guided):
    assert guided(zero=FAILED) == (["wire", "zero"], OUT_OF_TOLERANCE)
    assert guided(zero=PASSED) == (["zero", "push"], OK)
    assert guided() == ([], OK)


def test_another_description_begins_anew(guided, arm):
    assert guided()[1] == OK
    with open(arm / "robot.yaml", "a", encoding="utf-8") as file:
        file.write("# another sign, say\n")
    assert guided() == (["wire", "zero", "push"], OK)


def test_it_goes_back_but_never_ahead(guided):
    with pytest.raises(InputError, match="--from push: wire comes before it"):
        guided("push")
    assert guided()[1] == OK
    assert guided("zero") == (["zero", "push"], OK)
    with pytest.raises(InputError, match="expected one of wire, zero, push"):
        guided("zeros")


def test_the_protocol_names_arm_version_findings_and_cure(guided, tmp_path):
    guided(zero=FAILED)
    text = (tmp_path / "out" / "first_hour.md").read_text(encoding="utf-8")
    for part in ("desktop2r", "limber 0.", "## wire: passed", "## zero: failed", "To do: mend it"):
        assert part in text


@pytest.mark.parametrize("text", ["{", "[]", '{"format": "limber-first-hour/9"}', "null"])
def test_a_record_that_is_none_is_refused(arm, tmp_path, text):
    (tmp_path / "first_hour.json").write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=r"first_hour\.json is no record"):
        Record(load_robot(str(arm)), tmp_path)


def test_a_record_is_read_as_it_was_written(arm, tmp_path):
    robot = load_robot(str(arm))
    Record(robot, tmp_path).note("zero", failed("a line", "a cure", "another"))
    found = Record(robot, tmp_path).found["zero"]
    assert (found.verdict, found.lines, found.cure) == (FAILED, ("a line", "another"), "a cure")
    assert found.when
    assert json.loads((tmp_path / "first_hour.json").read_text(encoding="utf-8"))["steps"]
