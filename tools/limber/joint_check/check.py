"""Leads a person from joint to joint."""

import time
from dataclasses import dataclass

import numpy as np
from rich.text import Text

from limber.joint_check import judge, wiring, words
from limber.joint_check.drives import Drives, Readings
from limber.joint_check.judge import Finding, Step, Verdict
from limber.joint_check.results import SKIPPED, Row
from limber.joint_check.screen import Screen
from limber.joint_check.view import BAD, GOOD, WARN, awaited, picture
from limber.keys import ENTER, Keys
from limber.model.robot import Robot

PERIOD_S = 0.05
SKIP, REPEAT, OTHER_WAY, QUIT = "s", "r", "o", "q"
STEP_KEYS = "s skip, r repeat, o the other direction, q quit"
ASK_KEYS = "Enter go on, r repeat, q quit"


@dataclass(frozen=True)
class Amounts:
    """How far to turn or move a joint."""

    angle_rad: float = 0.2
    length_m: float = 0.02


class Check:
    """`rows`: what has been found so far, a row for each joint."""

    def __init__(
        self, robot: Robot, keys: list[wiring.JointKeys], amounts: Amounts, drives: Drives
    ) -> None:
        self.rows = [Row(name) for name in robot.joint_names]
        self._robot, self._keys, self._drives = robot, keys, drives
        self._slides = words.slides(robot)
        ranges = np.array([joint.high - joint.low for joint in robot.joints])
        slides = np.array(self._slides)
        self._amounts = judge.amounts(slides, ranges, amounts.angle_rad, amounts.length_m)
        self._truth: dict[int, tuple[int, int]] = {}  # joint -> whose reading is its, and the sign

    def run(self, screen: Screen, person: Keys) -> None:
        """Ends early by KeyboardInterrupt, q as well as Ctrl-C, and by RunError if a drive is not
        off."""
        self._await_readings(screen, person)
        if self._drives.controller_heard():
            screen.tell("A controller runs, too: nobody may request HOLD meanwhile.", WARN)
        for joint in range(len(self.rows)):
            self.rows[joint] = self._joint(joint, screen, person)

    def _await_readings(self, screen: Screen, person: Keys) -> None:
        while self._drives.read() is None:
            text = f"Waiting: {self._drives.awaited}."
            screen.show(Text(f"{text} q quit"), text)
            for line in self._drives.news():
                screen.tell(line, WARN)
            if person.pressed() == QUIT:
                raise KeyboardInterrupt
            time.sleep(PERIOD_S)

    def _joint(self, joint: int, screen: Screen, person: Keys) -> Row:
        name, way = self.rows[joint].joint, 0
        while True:
            step = Step(joint, way, self._amounts)
            found = self._turn(step, screen, person)
            if found == SKIP:
                screen.tell(f"{name}: skipped", WARN)
                return Row(name, SKIPPED)
            if isinstance(found, str):
                way = -step.way if found == OTHER_WAY else way
                continue
            row = self._row(step, found)
            screen.tell(_told(row), GOOD if found.verdict is Verdict.OK else BAD)
            if found.verdict is Verdict.SEVERAL:
                continue
            if found.verdict is Verdict.OK or self._ask(row, screen, person) != REPEAT:
                self._note_truth(step, found)
                return row

    def _turn(self, step: Step, screen: Screen, person: Keys) -> Finding | str:
        """Until the joint has been turned, or a key says otherwise."""
        person.forget()
        task = ""
        while True:
            readings = self._drives.read()
            found = None if readings is None else self._take(step, readings)
            if found is not None:
                return found
            if step.at_rest and not task:
                task = self._task(step)
            name = self.rows[step.joint].joint
            texts = [task or f"{name} is next.", awaited(self.names, step), STEP_KEYS]
            told = bool(task) and not step.missing
            view = picture(self.names, self._slides, step, texts)
            screen.show(view, task if told else texts[1], at_once=told)
            key = person.pressed()
            if key == QUIT:
                raise KeyboardInterrupt
            if key in (SKIP, REPEAT, OTHER_WAY):
                return key
            time.sleep(PERIOD_S)

    @property
    def names(self) -> list[str]:
        return self._robot.joint_names

    def _take(self, step: Step, readings: Readings) -> Finding | None:
        found = step.take(readings.time_s, readings.theta, readings.fresh, readings.apart)
        if step.at_rest and not step.way:
            joint = self._robot.joints[step.joint]
            amount = float(self._amounts[step.joint])
            step.way = judge.direction(step.q[step.joint], joint.low, joint.high, amount)
        return found

    def _task(self, step: Step) -> str:
        name, keys = self.names[step.joint], self._keys[step.joint]
        change = step.way * float(self._amounts[step.joint])
        pose = self._as_it_is(step.q)
        return (
            f"{name}, {step.joint + 1} of {len(self.rows)} ({keys.where()}): "
            f"{'move' if self._slides[step.joint] else 'turn'} it by hand "
            f"{words.motion_words(self._robot, step.joint, pose, change)}."
        )

    def _as_it_is(self, q: np.ndarray) -> np.ndarray:
        """The pose without what has been found wrong."""
        pose = np.array(q, float)
        for joint, (source, sign) in self._truth.items():
            pose[joint] = sign * q[source]
        return pose

    def _note_truth(self, step: Step, found: Finding) -> None:
        right = 1 if found.moved * step.way > 0 else -1
        self._truth[step.joint] = found.joints[0], right

    def _row(self, step: Step, found: Finding) -> Row:
        moved = found.joints[0]
        return Row(
            self.names[step.joint],
            found.verdict.value,
            found.moved,
            self.names[moved],
            self._slides[moved],
            wiring.explanation(self._keys, step.joint, found),
            wiring.changes(self._keys, step.joint, step.way, found),
        )

    def _ask(self, row: Row, screen: Screen, person: Keys) -> str:
        """Whether what was found wrong shall count; the drives are watched meanwhile."""
        person.forget()
        while not person.ended:
            self._drives.read()
            text = f"{row.joint}: {ASK_KEYS}"
            screen.show(Text(text), text, at_once=True)
            key = person.pressed()
            if key == QUIT:
                raise KeyboardInterrupt
            if key in (ENTER, REPEAT):
                return key
            time.sleep(PERIOD_S)
        return ENTER


def _told(row: Row) -> str:
    lines = [f"{row.joint}: {row.verdict}, moved by {row.moved_words()}", row.text]
    lines += [wiring.change_words(change) for change in row.changes]
    return "\n  ".join(line for line in lines if line)
