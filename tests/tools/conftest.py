"""What the tests of the tools share."""

import socket
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest

from limber.model.scenario import load_scenario


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
