"""Logs made from formulas, so that every test knows what has to come out."""

import signal
import socket
import subprocess
import sys
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

from limber import messages
from limber.log.event_file import HEADER, SYNC
from limber.model.scenario import load_scenario

ROOT = Path(__file__).resolve().parents[2]
RATE_HZ = 200

# A shell that starts the tests in the background has its children ignore Ctrl-C; tests send it.
signal.signal(signal.SIGINT, signal.default_int_handler)


def records(type_name: str, count: int, **fields) -> np.ndarray:
    """`count` messages of a type, numbered from 0; other fields as given, the rest zero."""
    made = np.zeros(count, messages.dtype_of(type_name))
    made[messages.FINGERPRINT] = messages.fingerprint_of(type_name)
    made[made.dtype.names[1]] = np.arange(count)
    for name, values in fields.items():
        made[name] = values
    return made


def event_bytes(channel: str, data: bytes, number: int = 0, stamp_us: int = 0) -> bytes:
    header = HEADER.pack(SYNC, number, stamp_us, len(channel), len(data))
    return header + channel.encode() + data


def write_log(path: Path, channels: dict[str, np.ndarray]) -> Path:
    """All channels' messages in order of their time."""
    events = [
        (int(record["time_ns"]), channel, record.tobytes())
        for channel, rows in channels.items()
        for record in rows
    ]
    events.sort(key=lambda event: event[0])
    with open(path, "wb") as file:
        for number, (time_ns, channel, data) in enumerate(events):
            file.write(event_bytes(channel, data, number, time_ns // 1000))
    return path


@pytest.fixture
def scenario_file(tmp_path: Path) -> Callable[[str, str], Path]:
    """Writes a scenario for a robot with the given timeline (YAML text)."""

    def write(robot: str, text: str) -> Path:
        path = tmp_path / "scenario.yaml"
        head = f"format: limber-scenario/1\nrobot: {robot}\nmode: lockstep\n"
        path.write_text(head + text, encoding="utf-8")
        return path

    return write


@pytest.fixture
def scenario(scenario_file):
    return lambda robot, text: load_scenario(scenario_file(robot, text))


@pytest.fixture(scope="session")
def limber() -> Callable[..., subprocess.CompletedProcess]:
    """Runs the command line as a user would."""

    def call(*arguments: str, cwd: Path | None = None) -> subprocess.CompletedProcess:
        return subprocess.run(
            [sys.executable, "-m", "limber", *arguments],
            capture_output=True,
            text=True,
            timeout=60,
            cwd=cwd,
            stdin=subprocess.DEVNULL,
        )

    return call


def free_port() -> int:
    with closing(socket.socket()) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@pytest.fixture
def served():
    """The server of `limber monitor`, without a browser."""
    from limber.monitor import server

    started = server.start(free_port())
    yield started
    started.close()
