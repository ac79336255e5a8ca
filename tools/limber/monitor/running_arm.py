"""Which arm the running stack drives: by ROBOT_INFO, so that nobody has to name it."""

import time
from pathlib import Path

from rich.console import Console

from limber.errors import InputError
from limber.model.robot import Robot, load_robot
from limber.monitor.feed import Batch
from limber.monitor.live_feed import LiveFeed

FOUND_S = 1.0
WITHOUT_STACK = "openarm"


class RunningArm:
    """`name` and `folder` of the newest ROBOT_INFO, empty before."""

    def __init__(self) -> None:
        self.name = self.folder = ""

    def note(self, batch: Batch) -> None:
        for info in batch.objects.get("ROBOT_INFO", []):
            self.name, self.folder = info.robot, info.folder

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
