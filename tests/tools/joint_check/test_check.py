"""From joint to joint, with an arm and a person made of plain numbers."""

import io
import json
from dataclasses import dataclass, field

import numpy as np
import pytest
from rich.console import Console

from limber.errors import RunError
from limber.joint_check import check, results, wiring
from limber.joint_check.check import Amounts, Check
from limber.joint_check.drives import Readings
from limber.joint_check.screen import Screen
from limber.model.robot import load_robot

TURN = 0.25


@dataclass
class Arm:
    """Reads what `wires` make of the true angles: joint -> (whose angle, sign).

    After the person has been asked for a joint, it is turned as `plan` has it: its own name gives
    true changes by joint. Twenty readings a second of its own time.
    """

    plan: list[dict[int, float]]
    wires: dict[int, tuple[int, int]] = field(default_factory=dict)
    fails_at: int = 2000
    readings: int = 0
    q: np.ndarray = field(default_factory=lambda: np.array([0.3, 0.8]))
    awaited = "nothing"
    simulated = False

    def read(self) -> Readings:
        self.readings += 1
        if self.readings > self.fails_at:
            raise RunError("the drives have become ON, not OFF")
        if self.readings % 40 == 0 and self.plan:  # 2 s after the last: at rest
            for joint, change in self.plan.pop(0).items():
                self.q[joint] += change
        wires = [self.wires.get(i, (i, 1)) for i in range(2)]
        q = np.array([sign * self.q[source] for source, sign in wires])
        return Readings(0.05 * self.readings, q, np.zeros(2), np.ones(2, bool))

    def news(self) -> list[str]:
        return []

    def controller_heard(self) -> bool:
        return False


class Person:
    """Presses keys, each at its reading of the arm; without any it cannot answer."""

    def __init__(self, arm: Arm, keys: dict[int, str]) -> None:
        self._arm, self._keys = arm, keys
        self.ended = not keys

    def pressed(self) -> str | None:
        due = [at for at in self._keys if at <= self._arm.readings]
        return self._keys.pop(min(due)) if due else None

    def forget(self) -> None:
        pass


@pytest.fixture(autouse=True)
def no_time_passes(monkeypatch):
    monkeypatch.setattr(check.time, "sleep", lambda _s: None)


def checked(arm: Arm, keys: dict[int, str] | None = None) -> tuple[dict, str]:
    robot = load_robot("planar2r")
    places = wiring.read_keys(robot.folder / "robot.yaml", robot.joint_names)
    made = Check(robot, places, Amounts(), arm)
    out = io.StringIO()
    with Screen(Console(file=out, width=100)) as screen:
        try:
            made.run(screen, Person(arm, keys or {}))
        except KeyboardInterrupt:
            screen.tell("stopped")
    return {row.joint: row for row in made.rows}, out.getvalue()


def verdicts(rows: dict) -> list[str]:
    return [row.verdict for row in rows.values()]


def test_both_right():
    rows, text = checked(Arm([{0: TURN}, {1: TURN}]))
    assert verdicts(rows) == ["ok", "ok"] and results.passed(list(rows.values()))
    assert text.count("turn it by hand") == 2
    assert "shoulder, 1 of 2 (id 1 on arm)" in text and "elbow, 2 of 2 (id 2 on arm)" in text


def test_a_sign():
    rows, text = checked(Arm([{0: TURN}, {1: TURN}], wires={1: (1, -1)}))
    assert verdicts(rows) == ["ok", "sign"] and not results.passed(list(rows.values()))
    assert "joints.elbow.sign: -1, a new key (robot.yaml:" in text


def test_a_wrong_sign_does_not_turn_later_words_around():
    """A shoulder at +90 degrees that reads -90: the elbow's way is told for +90."""
    arm = Arm([{0: TURN}, {1: TURN}], wires={0: (0, -1)}, q=np.array([np.pi / 2 - TURN, 0.0]))
    rows, text = checked(arm)
    assert verdicts(rows) == ["sign", "ok"]
    elbow = next(line for line in text.splitlines() if line.startswith("elbow, 2 of 2"))
    assert "the tip moves along -x, 8 cm" in elbow


def test_exchanged():
    rows, _ = checked(Arm([{0: TURN}, {1: TURN}], wires={0: (1, 1), 1: (0, 1)}))
    assert verdicts(rows) == ["exchanged", "exchanged"]
    assert rows["shoulder"].moved_joint == "elbow"
    assert [(c.key, c.write) for c in rows["shoulder"].changes] == [("joints.shoulder.id", "2")]


def test_several_is_tried_again():
    rows, text = checked(Arm([{0: TURN, 1: 0.2}, {0: TURN}, {1: TURN}]))
    assert verdicts(rows) == ["ok", "ok"]
    assert "hold the others and turn shoulder alone" in text
    assert text.count("turn it by hand") == 3


def test_skipped_is_not_right():
    rows, _ = checked(Arm([{1: TURN}]), {20: "s"})
    assert verdicts(rows) == ["skipped", "ok"] and not results.passed(list(rows.values()))


def test_repeat_and_the_other_direction():
    rows, text = checked(Arm([{}, {0: -TURN}, {1: TURN}]), {20: "o", 30: "r"})
    assert verdicts(rows) == ["ok", "ok"] and rows["shoulder"].moved < 0
    assert "clockwise" in text


def test_a_wrong_finding_can_be_repeated():
    """The hand was at the wrong joint."""
    rows, text = checked(Arm([{1: TURN}, {0: TURN}, {1: TURN}]), {60: "r", 999: "s"})
    assert verdicts(rows) == ["ok", "ok"] and "shoulder: exchanged" in text


def test_enter_takes_it():
    rows, _ = checked(Arm([{0: -TURN}, {1: TURN}]), {60: "\n", 999: "s"})
    assert verdicts(rows) == ["sign", "ok"]


def test_quit_leaves_the_rest_open():
    rows, text = checked(Arm([{0: TURN}]), {70: "q"})
    assert verdicts(rows) == ["ok", "not checked"] and "stopped" in text


def test_a_drive_that_is_not_off_ends_it():
    with pytest.raises(RunError, match="become ON"):
        checked(Arm([{0: TURN}], fails_at=20))


def test_as_data(tmp_path):
    rows, _ = checked(Arm([{0: TURN}, {1: -TURN}]))
    results.write_json(list(rows.values()), tmp_path, tmp_path / "x.json")
    content = json.loads((tmp_path / "x.json").read_text(encoding="utf-8"))
    assert content["passed"] is False
    shoulder, elbow = content["joints"]
    assert shoulder["verdict"] == "ok" and shoulder["changes"] == [] and shoulder["unit"] == "rad"
    assert elbow["verdict"] == "sign" and elbow["moved"] == pytest.approx(-TURN, abs=0.02)
    assert elbow["changes"][0]["key"] == "joints.elbow.sign"
    assert elbow["changes"][0]["write"] == "-1" and elbow["changes"][0]["line"] > 1
