"""The simulated drives on the kernel's CAN, as clients see them that need it.

The clients are on vxcan0 and the drives at the other end of the cable, vxcan1.
"""

import json
import re
import subprocess
import sys
import time
from pathlib import Path

import can_motor_control as cmc
import numpy as np
import pytest
from can_motor_control import damiao

PROGRAMS = Path(sys.executable).parent
CLIENTS, DRIVES = "vxcan0", "vxcan1"
PATIENT = ("--timeout-ms", "1000")


@pytest.fixture
def wire():
    """Answers take 10 ms: motorbridge misses what answers before it has begun to wait, as drives
    without a wire do, and gives up after 50 ms.
    """
    qdisc = ["tc", "qdisc", "add", "dev", DRIVES, "root", "netem", "delay", "10ms"]
    subprocess.run(qdisc, check=True)
    yield
    subprocess.run(["tc", "qdisc", "del", "dev", DRIVES, "root"], check=True)


def run(name: str, *arguments: str) -> str:
    done = subprocess.run(
        [str(PROGRAMS / name), *arguments],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        stdin=subprocess.DEVNULL,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def simulate(stack, robot: str, *arguments: str) -> None:
    stack.robot = robot
    stack.start("sim", "--realtime", "--bus", f"arm=socketcan:{DRIVES}", *arguments)
    stack.until(lambda: stack.truth is not None, 60, "the simulator")


def bridge(*arguments: str) -> str:
    command, *rest = arguments
    return run("motorbridge-cli", command, "--vendor", "damiao", "--channel", CLIENTS, *rest)


def test_motorbridge_scans_and_changes_identifiers(stack, wire):
    simulate(stack, "desktop2r")
    found = bridge("scan", "--model", "4310", "--start-id", "1", "--end-id", "4", *PATIENT)
    assert "0x1" in found and "0x2" in found, found
    shoulder = ("--model", "4310", "--motor-id", "1", "--feedback-id", "0x11")
    moved = bridge("id-set", *shoulder, "--new-motor-id", "4", "--new-feedback-id", "0x14")
    assert re.search(r"verify rid=8 \(ESC_ID\): 0x4\b", moved), moved
    assert re.search(r"verify rid=7 \(MST_ID\): 0x14\b", moved), moved
    dump = bridge(
        "id-dump", "--model", "4310", "--motor-id", "4", "--feedback-id", "0x14", *PATIENT
    )
    assert "0x4" in dump, dump


@pytest.mark.parametrize(
    "mode, options, position, velocity",
    [
        ("pos-vel", ("--pos", "-1.0", "--vlim", "2.0"), -1.0, 0.0),
        ("vel", ("--vel", "0.5"), None, 0.5),
        ("force-pos", ("--pos", "-1.0", "--vlim", "2.0", "--ratio", "0.9"), -1.0, 0.0),
    ],
)
def test_motorbridge_moves_the_shoulder(stack, wire, mode, options, position, velocity):
    """What the client itself has read at the end; the elbow hangs free."""
    simulate(stack, "desktop2r", "--no-stand")
    shoulder = ("--model", "4310", "--motor-id", "1", "--feedback-id", "0x11")
    repeat = ("--loop", "100", "--dt-ms", "20", "--verify-model", "0", "--print-state", "1")
    said = bridge("run", *shoulder, "--mode", mode, *options, *repeat)
    *_, last = re.findall(r"pos=(\S+) vel=(\S+) torq=\S+ status=1", said)
    if position is not None:
        assert float(last[0]) == pytest.approx(position, abs=0.03)
    assert float(last[1]) == pytest.approx(velocity, abs=0.1)


def test_can_motor_control_holds_all_seven(stack):
    simulate(stack, "openarm")
    types = ["DM8009", "DM8009", "DM4340", "DM4340", "DM4310", "DM4310", "DM4310"]
    motors = [
        cmc.MotorSpec(f"j{i + 1}", getattr(damiao.MotorType, kind), i + 1, i + 0x11)
        for i, kind in enumerate(types)
    ]
    builder = cmc.RobotBuilder()
    builder = builder.add_bus("can", cmc.SocketCanBus(CLIENTS, fd=True), damiao.DamiaoCodec())
    robot = builder.add_arm("arm", bus="can", motors=motors).build()
    robot.connect()
    robot.enable()
    arm = robot["arm"]
    for _ in range(20):
        arm.refresh()
        robot.tick(50_000)
    begin = arm.positions()
    assert begin == pytest.approx(np.array(stack.truth.q[:7]), abs=1e-3)
    for _ in range(100):
        command = [[100.0, 2.0, q, 0.0, 0.0] for q in begin]
        arm.mit_control(np.array(command))
        robot.tick(50_000)
        time.sleep(0.01)
    assert np.abs(arm.positions() - begin).max() < 0.1
    assert all(arm[f"j{i + 1}"].is_enabled for i in range(7))
    robot.disable()


def test_moteus_tool_over_socketcan(stack):
    simulate(stack, "planar2r")
    bus = ("--force-transport", "pythoncan", "--can-iface", "socketcan", "--can-chan", CLIENTS)
    config = run("moteus_tool", "--target", "1", *bus, "--dump-config")
    assert "servo.pid_position.kp 4000" in config
    assert json.loads(run("moteus_tool", "--target", "2", *bus, "--info"))["model"] == "200"
