"""Which arm the running stack drives: by ROBOT_INFO, so that nobody has to name it."""

import os
import signal
import time
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

from rich.console import Console

from limber.errors import InputError
from limber.model.robot import Robot, load_robot
from limber.monitor.feed import Batch
from limber.monitor.live_feed import LiveFeed

NICENESS = 5  # the control loop goes first
FOUND_S = 1.0
WITHOUT_STACK = "openarm"


class RunningArm:
    """`name` and `folder` of the newest ROBOT_INFO, empty before."""

    def __init__(self) -> None:
        self.name = self.folder = ""

    def note(self, batch: Batch) -> None:
        for info in batch.objects.get("ROBOT_INFO", []):
            self.name, self.folder = info.robot, info.folder

    def other_than(self, robot: Robot) -> str:
        """The name of another arm that runs, or an empty one."""
        return "" if self.name == robot.name else self.name

    def wait(self, feed: LiveFeed) -> None:
        end = time.monotonic() + FOUND_S
        while not self.name and time.monotonic() < end:
            self.note(feed.take())
            time.sleep(0.02)


def choose_robot(named: str | None, running: RunningArm, console: Console) -> Robot:
    """The one that is named, else the running one, else a default until there is a stack."""
    if named is not None:
        return load_robot(named)
    if not running.name:
        console.print(f"no stack is running yet; showing {WITHOUT_STACK}", style="yellow")
        return load_robot(WITHOUT_STACK)
    try:
        return load_robot(running.folder if Path(running.folder).is_dir() else running.name)
    except InputError as error:
        raise InputError(
            f"the running arm {running.name} is described in {running.folder}, which cannot be "
            f"read here: name its folder with --robot ({error})"
        ) from error


Show = Callable[[Robot, LiveFeed, RunningArm], bool]


def follow_arms(named: str | None, console: Console, show: Show) -> None:
    """Shows the arm that is named, else the one that runs and, as often as `show` returns True, the
    one that runs then; tells at the end what was received. SIGTERM is Ctrl-C.
    """
    os.nice(NICENESS)
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    running = RunningArm()
    with closing(LiveFeed()) as feed:
        if named is None:
            running.wait(feed)
        while show(choose_robot(named, running, console), feed, running):
            console.print(f"another arm is running: {running.name}", style="yellow")
        console.print(feed.received())
