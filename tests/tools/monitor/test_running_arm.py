"""Which arm is shown: the one that is named, or whichever runs."""

from types import SimpleNamespace

import pytest
from rich.console import Console

from limber.monitor import running_arm
from limber.monitor.feed import Batch


class Feed:
    """Of a stack that drives `names`, one after the other, a take() each."""

    def __init__(self, *names: str) -> None:
        self._names = list(names)

    def take(self) -> Batch:
        name = self._names.pop(0) if self._names else None
        infos = [] if name is None else [SimpleNamespace(robot=name, folder="/nowhere")]
        return Batch({}, {"ROBOT_INFO": infos})

    def received(self) -> str:
        return "all received"

    def close(self) -> None:
        self._names = []


@pytest.fixture
def followed(monkeypatch, capsys):
    """Follows arms for so many shows; returns those shown and what was told."""

    def follow(feed: Feed, named: str | None, times: int) -> tuple[list[str], str]:
        monkeypatch.setattr(running_arm, "LiveFeed", lambda: feed)
        monkeypatch.setattr(running_arm, "FOUND_S", 0.1)
        monkeypatch.setattr(running_arm.os, "nice", lambda _by: 0)
        monkeypatch.setattr(running_arm.signal, "signal", lambda *_: None)
        shown: list[str] = []

        def show(robot, feed, running) -> bool:
            shown.append(robot.name)
            running.note(feed.take())
            return len(shown) < times

        running_arm.follow_arms(named, Console(width=100), show)
        return shown, capsys.readouterr().out

    return follow


def test_the_one_that_runs_is_shown_and_then_the_next_one(followed):
    shown, told = followed(Feed("iiwa14", "panda"), None, 2)
    assert shown == ["iiwa14", "panda"]
    assert told.splitlines() == ["another arm is running: panda", "all received"]


def test_the_one_that_is_named_is_shown_whatever_runs(followed):
    shown, told = followed(Feed("panda"), "iiwa14", 1)
    assert shown == ["iiwa14"] and told.splitlines() == ["all received"]


def test_without_a_stack_one_is_shown_until_there_is_one(followed):
    shown, told = followed(Feed(), None, 1)
    assert shown == [running_arm.WITHOUT_STACK] and "no stack is running yet" in told


def test_only_another_arm_is_another():
    running, robot = running_arm.RunningArm(), SimpleNamespace(name="panda")
    assert running.other_than(robot) == ""
    for name, other in (("panda", ""), ("iiwa14", "iiwa14")):
        running.note(Feed(name).take())
        assert running.other_than(robot) == other
