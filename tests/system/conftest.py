"""System tests run in a private network namespace: `limber test` starts pytest inside one."""

import signal
import socket
import subprocess

import pytest

from limber.lcmtypes.controller_status_t import controller_status_t as Status
from limber_qa.check_trace.judge import judge_file
from limber_qa.check_trace.stops import Expectation
from limber_qa.faults.matrix import read_matrix
from stack import BIN, Stack, slow_arm

PAUSE_CYCLES = 60  # the frames' stamps are the clock's: what the machine adds

# A shell that starts the tests in the background has its children ignore Ctrl-C; tests send it.
signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_configure(config):
    """Refuse to run where other LCM programs could hear us or disturb us."""
    interfaces = [name for _, name in socket.if_nameindex()]
    others = [
        name
        for name in interfaces
        if name != "lo" and not name.startswith(("vcan", "vxcan", "can"))
    ]
    if others:
        pytest.exit(
            "system tests need a private network: run them with `./limber test`, or\n"
            "  unshare -rn sh -c 'ip link set lo up; ip link set lo multicast on; "
            "ip route add 224.0.0.0/4 dev lo; .venv/bin/pytest tests/system'",
            returncode=4,
        )


@pytest.fixture(autouse=True)
def own_black_boxes(tmp_path, monkeypatch):
    """Neither in the user's folder, nor mixed with those of other runs."""
    monkeypatch.setenv("LIMBER_BLACK_BOXES", str(tmp_path / "black_boxes"))


@pytest.fixture
def stack(request, tmp_path):
    """Paced; of tests marked `realtime` in real time, of an arm slow enough for a busy machine."""
    if request.node.get_closest_marker("realtime"):
        running = Stack(tmp_path, slow_arm(tmp_path / "slow_openarm"), "--realtime")
    else:
        running = Stack(tmp_path)
    try:
        yield running
    finally:
        running.close()


@pytest.fixture
def standing(stack):
    """Drives that may be switched on."""
    stack.start_all()
    stack.until(lambda: stack.mode == Status.MODE_IDLE, 20, "IDLE")
    return stack


def pytest_collection_modifyitems(items):
    """Tests of the fault matrix that are known to fail have to: a cure turns them red."""
    known = {
        test.test: test.known_failing
        for row in read_matrix()
        for test in row.tests
        if test.known_failing
    }
    for item in items:
        name = f"tests/system/{item.path.name}::{item.originalname}"
        if name in known:
            item.add_marker(pytest.mark.xfail(strict=True, reason=known[name]))


@pytest.fixture
def judged(stack, tmp_path):
    """The stack, with all its CAN frames recorded; at the end the trace checker judges them."""
    trace = tmp_path / "frames.log"
    recorder = subprocess.Popen(
        [BIN / "limber-can", "record", stack.robot, "--out", trace],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        yield stack
    finally:
        recorder.send_signal(signal.SIGINT)
        recorder.wait(timeout=300)
    verdict = judge_file(trace, stack.robot, Expectation(silent_cycles=PAUSE_CYCLES))
    assert verdict.commands > 0
    assert verdict.breaches == [], verdict.breaches[:3]


@pytest.fixture
def motors(stack, limber):
    """Calls `limber motors COMMAND BUS ...` beside the simulated arm `start(name)`."""

    def start(robot: str):
        stack.robot = robot
        stack.start("sim", "--realtime")
        stack.until(lambda: stack.truth is not None, 20, "the simulator")
        fd = ["--fd"] if robot in ("planar2r", "testbench") else []

        def call(command: str, *words: str):
            return limber("motors", command, f"virtual:{robot}", *words, *fd)

        return call

    return start
