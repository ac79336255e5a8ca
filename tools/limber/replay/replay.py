"""Sends the messages of a log at the pace of the recording, unless an arm is running there."""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import Progress

from limber import messages
from limber.errors import InputError, RunError
from limber.live.line import Line
from limber.log.reader import Log
from limber.replay.address import address
from limber.replay.choice import choose
from limber.replay.silence import require_silence

LONGEST_PAUSE_S = 10.0
SHORTENED_S = 1.0


@dataclass(frozen=True)
class ReplayOptions:
    """`begin_s`, `end_s`: since the first message of the log."""

    speed: float = 1.0
    begin_s: float = 0.0
    end_s: float = float("inf")
    channels: tuple[str, ...] = ()
    url: str | None = None
    commands_as: str = ""
    with_commands: bool = False


@dataclass
class Sent:
    messages: int = 0
    behind_s: float = 0.0
    shortened: list[float] = field(default_factory=list)  # pauses, s


def replay(path: Path, options: ReplayOptions, console: Console) -> None:
    target = address(options.url)
    if options.with_commands and not target.private:
        raise InputError(
            f"--with-commands: a running arm could hear them on {target.url}; give a port of its "
            "own with --url, such as udpm://239.255.76.67:7700?ttl=0, and start there what is to "
            "hear them"
        )
    log = Log(path)
    sent, left_out = choose(
        log.channels, options.channels, options.commands_as, options.with_commands
    )
    if not sent:
        raise InputError(f"{log.path}: nothing is left to send: {_why(left_out)}")
    first_us, length_s = log.first_us, log.length_s
    if options.begin_s >= min(options.end_s, length_s):
        raise InputError(f"--from {options.begin_s:g}: the log ends after {length_s:g} s")
    line = Line(target.url)
    require_silence(line, target.url)
    if log.damage():
        console.print(log.damage(), style="yellow", soft_wrap=True)
    for name, why in left_out.items():
        line_of_it = f"not sent: {name} ({len(log.channels[name])} messages): {why}"
        console.print(line_of_it, style="yellow", markup=False, soft_wrap=True)
    done = Sent()
    end_s = min(options.end_s, length_s)
    begin_us, end_us = first_us + options.begin_s * 1e6, first_us + end_s * 1e6
    with (
        _Watch(line, log, sent) as watch,
        Progress(console=console, transient=True, disable=not console.is_terminal) as progress,
    ):
        task = progress.add_task(f"replaying {log.path.name}, s", total=end_s - options.begin_s)

        def turn(stamp_us: int) -> None:
            watch.check()
            progress.update(task, completed=(stamp_us - begin_us) * 1e-6)

        for channel, data in _paced(log, set(sent), (begin_us, end_us), options.speed, done, turn):
            line.publish(sent[channel], data)
            done.messages += 1
    _tell(done, target.url, console)


def _paced(
    log: Log,
    channels: set[str],
    range_us: tuple[float, float],
    speed: float,
    done: Sent,
    turn: Callable[[int], None],
) -> Iterator[tuple[str, bytes]]:
    """The messages when they are due. `turn` is called about ten times a second."""
    before_us: int | None = None
    turned_s = start_s = time.monotonic()
    due_s = 0.0  # since the start
    for stamp_us, channel, data in log.in_order(channels):
        if not range_us[0] <= stamp_us <= range_us[1]:
            continue
        pause_s = max(0.0, (stamp_us - (before_us or stamp_us)) * 1e-6)
        before_us = stamp_us
        if pause_s > LONGEST_PAUSE_S:
            done.shortened.append(pause_s)
            pause_s = SHORTENED_S
        due_s += pause_s / speed
        while (wait_s := start_s + due_s - time.monotonic()) > 0:
            time.sleep(min(wait_s, 0.1))
            if time.monotonic() - turned_s > 0.1:
                turned_s = time.monotonic()
                turn(stamp_us)
        done.behind_s = max(done.behind_s, -wait_s)
        yield channel, data
        if time.monotonic() - turned_s > 0.1:
            turned_s = time.monotonic()
            turn(stamp_us)


class _Watch:
    """Ends the replay when a driver starts on the same address: its states name another session
    than those of the log.
    """

    def __init__(self, line: Line, log: Log, sent: dict[str, str]) -> None:
        self._line = line
        self._foreign = False
        self._sessions = _sessions(log) if "JOINT_STATE" in sent else set()

    def __enter__(self) -> "_Watch":
        self._subscription = self._line.subscribe("JOINT_STATE", self._hear)
        return self

    def __exit__(self, *_error: object) -> None:
        self._line.unsubscribe(self._subscription)

    def check(self) -> None:
        while self._line.handle_timeout(0):
            pass
        if self._foreign:
            raise RunError("a driver has started on this address: the replay is stopped")

    def _hear(self, _channel: str, data: bytes) -> None:
        try:
            session = int(messages.view("joint_state_t", data)["session"])
        except ValueError:
            return  # of another version: its own sender knows
        self._foreign |= session not in self._sessions


def _sessions(log: Log) -> set[int]:
    try:
        return set(np.unique(log.fields("JOINT_STATE", "session")["session"]).tolist())
    except InputError:  # of another version: not heard as states at all
        return set()


def _why(left_out: dict[str, str]) -> str:
    return "; ".join(f"{name}: {why}" for name, why in left_out.items())


def _tell(done: Sent, url: str, console: Console) -> None:
    for pause_s in done.shortened:
        text = f"a pause of {pause_s:.0f} s in the log was shortened to {SHORTENED_S:g} s"
        console.print(text, style="yellow")
    if done.behind_s > 0.1:
        text = f"this machine fell up to {done.behind_s:.1f} s behind the recording"
        console.print(text, style="yellow")
    console.print(f"sent {done.messages} messages to {url}", soft_wrap=True)
