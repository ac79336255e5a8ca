"""Recordings, floods and forgeries on the planes: what must not move, disturb or stop an arm."""

import os
import subprocess
import sys
import threading
import time
from pathlib import Path

import lcm
import pytest

from limber.lcmtypes.compliance_gains_t import compliance_gains_t
from limber.lcmtypes.controller_status_t import controller_status_t as Status
from limber.lcmtypes.joint_state_t import joint_state_t as State
from limber.lcmtypes.mode_request_t import mode_request_t
from stack import ARM_URL, BIN, CLIENT, USER_URL

LOGPLAYER = str(Path(sys.executable).parent / "lcm-logplayer")


def active(stack) -> None:
    stack.start_all()
    stack.bring_to(Status.MODE_ACTIVE)


def send(*entries: str) -> None:
    command = [str(BIN / "limber-send"), "--client", str(CLIENT), *entries]
    subprocess.run(command, check=True, timeout=300)


def status(stack) -> Status:
    return stack.user.latest("CONTROLLER_STATUS")


def record_session(stack, path: Path) -> int:
    """Brings the arm to motion by requests, into an LCM log; returns how many there were."""
    with_log = subprocess.Popen([str(BIN / "limber-record"), "--out", str(path)])
    active(stack)
    send("goal: {offset_m: [0, 0, 0.05], duration_s: 1}", "gains: {K_x_translation_N_per_m: 50}")
    time.sleep(1.0)
    with_log.terminate()
    with_log.wait(20)
    requests = ("MODE_REQUEST", "COMPLIANCE_GOAL", "COMPLIANCE_GAINS")
    return sum(event.channel in requests for event in lcm.EventLog(str(path)))


def replay(path: Path) -> None:
    url = ["--lcm-url", USER_URL]
    subprocess.run(
        [LOGPLAYER, "--speed", "10", *url, "--regexp", "MODE_.*|COMPLIANCE_.*", str(path)],
        check=True,
        timeout=300,
        stdout=subprocess.DEVNULL,
    )


@pytest.mark.realtime
def test_a_log_replayed_to_another_run_moves_nothing(stack, tmp_path):
    requests = record_session(stack, tmp_path / "log")
    assert requests >= 4
    for name in ("driver", "controller", "sim"):
        stack.kill(name)
    stack.start_all()
    stack.until(lambda: stack.mode == Status.MODE_IDLE, 20, "the new controller to be ready")
    stack.until(lambda: status(stack).requests_refused == 0, 5, "its first status")
    replay(tmp_path / "log")
    stack.until(lambda: status(stack).requests_refused == requests, 10, "all to be refused")
    assert stack.mode == Status.MODE_IDLE
    assert stack.state.drive_state == State.DRIVE_OFF


def test_a_log_replayed_to_the_same_run_changes_nothing(stack, tmp_path):
    requests = record_session(stack, tmp_path / "log")
    before = status(stack).requests_refused
    replay(tmp_path / "log")
    stack.until(
        lambda: status(stack).requests_refused == before + requests, 10, "all to be refused"
    )
    assert stack.mode == Status.MODE_ACTIVE


def test_a_stop_needs_no_number(stack):
    active(stack)
    message = mode_request_t()
    message.request = mode_request_t.REQUEST_STOP
    stack.user.lcm.publish("MODE_REQUEST", message.encode())
    stack.until(lambda: stack.mode == Status.MODE_HOLD, 5, "the soft stop")


def refused_start(stack, tag: str, name: str, *arguments: str) -> str:
    process = stack.start(name, *arguments, tag=tag)
    assert process.wait(20) == 2, stack.log(tag)
    return stack.log(tag)


@pytest.mark.parametrize("robot", ["openarm", "desktop2r"])
def test_a_second_driver_does_not_start(stack, robot):
    """Of this arm, or of another one on the same arm plane."""
    active(stack)
    accepted = stack.driver_status.commands_accepted
    stack.robot = robot
    log = refused_start(stack, "second", "driver")
    assert f"process {stack.processes['driver'].pid}" in log
    stack.processes.pop("second")
    stack.until(
        lambda: stack.driver_status.commands_accepted > accepted + 500, 20, "the first to go on"
    )
    assert stack.state.drive_state == State.DRIVE_ON
    assert stack.mode == Status.MODE_ACTIVE


def test_a_second_simulator_does_not_start(stack):
    active(stack)
    log = refused_start(stack, "second", "sim")
    assert f"process {stack.processes['sim'].pid}" in log
    stack.processes.pop("second")
    assert stack.state.drive_state == State.DRIVE_ON


@pytest.mark.realtime
def test_a_driver_starts_where_a_killed_one_was(stack):
    active(stack)
    stack.kill("driver")
    stack.start("driver")
    stack.until(lambda: stack.mode == Status.MODE_FAULT, 10, "the new session")
    stack.acknowledge()


def test_a_log_nobody_reads_does_not_stop_the_controller(stack, tmp_path):
    reader, writer = os.pipe()  # never read
    stack.start("sim")
    command = [str(BIN / "limber-controller"), "--robot", "openarm", "--paced"]
    controller = subprocess.Popen(command, stdout=writer, stderr=writer, stdin=subprocess.DEVNULL)
    try:
        os.write(writer, bytes(60_000))
        stack.start("driver")
        stack.bring_to(Status.MODE_ACTIVE)
        refused = status(stack).requests_refused
        for _ in range(60):  # a line of log each 200 ms
            stack.request(mode_request_t.REQUEST_ACTIVE, client=0)
            time.sleep(0.05)
        stack.until(lambda: status(stack).requests_refused >= refused + 60, 10, "the refusals")
        assert stack.mode == Status.MODE_ACTIVE
        assert stack.state.drive_state == State.DRIVE_ON
        controller.terminate()
        assert controller.wait(5) == 0
    finally:
        controller.kill()
        os.close(reader)
        os.close(writer)


def test_a_flood_of_requests_does_not_stop_the_arm(stack):
    active(stack)
    flooding = threading.Event()

    def flood() -> None:
        line = lcm.LCM(USER_URL)
        gains = compliance_gains_t()
        gains.client = 12345
        data = gains.encode()
        while not flooding.wait(0.001):
            for _ in range(20):
                line.publish("COMPLIANCE_GAINS", data)

    thread = threading.Thread(target=flood)
    refused = status(stack).requests_refused
    thread.start()
    try:
        time.sleep(3.0)
        assert stack.state.drive_state == State.DRIVE_ON, stack.describe()
        assert stack.mode == Status.MODE_ACTIVE
        stack.request(mode_request_t.REQUEST_STOP)
        stack.until(lambda: stack.mode == Status.MODE_HOLD, 5, "the stop to be obeyed")
    finally:
        flooding.set()
        thread.join()
    assert status(stack).requests_refused > refused + 1000
    assert stack.state.drive_state == State.DRIVE_ON


@pytest.mark.realtime
def test_a_forged_state_ends_in_a_fault_that_can_be_acknowledged(stack):
    active(stack)
    arm = lcm.LCM(ARM_URL)
    for ahead in (1_000_000, 1_000_001):  # the second one confirms the first
        forged = State.decode(stack.state.encode())
        forged.seq += ahead
        arm.publish("JOINT_STATE", forged.encode())
    stack.until(lambda: stack.mode == Status.MODE_FAULT, 5, "the fault")
    stack.acknowledge()
    stack.bring_to(Status.MODE_HOLD)


def test_messages_of_another_version_are_counted(stack):
    active(stack)
    arm, user = lcm.LCM(ARM_URL), lcm.LCM(USER_URL)
    for line, channel in ((arm, "JOINT_TORQUE"), (arm, "JOINT_STATE"), (user, "MODE_REQUEST")):
        line.publish(channel, bytes(64))
    stack.until(
        lambda: (
            stack.driver_status.messages_undecodable == 1
            and status(stack).messages_undecodable == 2
        ),
        10,
        "all to be counted",
    )


ON_A_NETWORK = (
    "ip link set lo up; ip link add eth7 type veth peer name eth8; ip link set eth8 up; "
    "ip addr add 10.1.2.3/24 dev eth7; ip link set eth7 up; ip route add default via 10.1.2.1; "
    'exec "$@"'
)


def on_a_network(*command: str) -> subprocess.CompletedProcess:
    """In a network namespace whose multicast goes to a network interface."""
    return subprocess.run(
        ["unshare", "-n", "sh", "-c", ON_A_NETWORK, "sh", *command],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


def test_a_plane_that_is_open_to_the_network(stack):
    driver = [str(BIN / "limber-driver"), "--patience", "0.5"]
    simulated = on_a_network(*driver)
    assert "open to the network at eth7" in simulated.stderr
    assert "route add 224.0.0.0/4 dev lo" in simulated.stderr
    real = on_a_network(*driver, "--robot", "desktop2r", "--bus", "arm=socketcan:can7")
    assert real.returncode == 2
    assert "anybody on it can send requests to the arm" in real.stderr
