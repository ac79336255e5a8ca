"""The simulated moteus drives, as the maker's own client and moteus_tool see them."""

from __future__ import annotations

import asyncio
import json
import math
import os
import subprocess
import sys
from pathlib import Path

import moteus
import pytest
from local_drive import multicast_group

from stack import ROOT

SHOULDER, ELBOW = 1, 2  # of planar2r
GROUP = multicast_group("planar2r")
PATIENCE_S = 30.0


@pytest.fixture(autouse=True)
def arm(stack):
    stack.robot = "planar2r"
    stack.pace = "--realtime"
    stack.start("sim", "--realtime")
    stack.until(lambda: stack.truth is not None, 20, "the simulator")
    return stack


def talk(conversation):
    """Runs what is said to controllers 1 and 2, which are the arguments."""

    async def whole():
        transport = moteus.PythonCan(interface="udp_multicast", channel=GROUP)
        try:
            drives = [moteus.Controller(id=i, transport=transport) for i in (SHOULDER, ELBOW)]
            return await asyncio.wait_for(conversation(*drives), PATIENCE_S)
        finally:
            transport.close()

    return asyncio.run(whole())


def tool(*arguments: str, target: int = SHOULDER) -> str:
    """moteus_tool as its users start it; python-can's interface is all that differs."""
    command = [str(Path(sys.executable).parent / "moteus_tool"), "--target", str(target)]
    bus = ["--force-transport", "pythoncan", "--can-iface", "udp_multicast", "--can-chan", GROUP]
    done = subprocess.run(
        [*command, *bus, *arguments],
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
        stdin=subprocess.DEVNULL,
        cwd=os.environ.get("TMPDIR", "/tmp"),
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def settings(text: str) -> dict[str, float]:
    pairs = (line.split() for line in text.splitlines() if line.strip())
    return {name: float(value) for name, value in pairs}


def test_the_tool_reads_what_robot_yaml_says():
    found = settings(tool("--dump-config"))
    assert found["id.id"] == SHOULDER
    assert found["servo.pid_position.kp"] == pytest.approx(4000.0)
    assert found["servo.pid_position.kd"] == pytest.approx(200.0)
    assert math.isnan(found["servopos.position_min"])


def test_the_auxiliary_ports_are_read_as_unwired():
    async def conversation(shoulder, _elbow):
        return await shoulder.read_gpio()

    assert talk(conversation) == bytes(2)


def test_the_tool_restores_a_configuration(tmp_path):
    wanted = tmp_path / "wanted.cfg"
    wanted.write_text("servo.pid_position.kp 123.5\nservopos.position_max 0.4\n")
    tool("--restore-config", str(wanted))
    found = settings(tool("--dump-config"))
    assert found["servo.pid_position.kp"] == 123.5
    assert found["servopos.position_max"] == pytest.approx(0.4)
    assert settings(tool("--dump-config", target=ELBOW))["servo.pid_position.kp"] != 123.5


def test_the_tool_knows_the_drive_and_its_state():
    assert json.loads(tool("--info"))["model"] == "200"
    assert json.loads(tool("--read", "servo_stats"))["mode"] == 0


def test_the_tool_sets_the_zero_and_stops():
    tool("--set-offset", "0.125")

    async def position(shoulder, _):
        return (await shoulder.query()).values[moteus.Register.POSITION]

    assert talk(position) == pytest.approx(0.125, abs=2e-4)
    tool("--zero-offset")
    assert talk(position) == pytest.approx(0.0, abs=2e-4)
    tool("--stop")


def test_a_trajectory_is_completed(arm):
    async def move(shoulder, elbow):
        begin = (await elbow.query()).values[moteus.Register.POSITION]
        await shoulder.set_position(position=math.nan, watchdog_timeout=math.nan)
        await elbow.set_position_wait_complete(
            position=begin + 0.05, velocity_limit=0.2, accel_limit=0.5, watchdog_timeout=math.nan
        )
        await asyncio.sleep(0.5)
        return begin, (await elbow.query()).values

    begin, values = talk(move)
    assert values[moteus.Register.MODE] == 10
    assert values[moteus.Register.POSITION] == pytest.approx(begin + 0.05, abs=0.02)


def test_what_is_not_emulated_is_a_fault():
    async def ask(shoulder, _):
        await shoulder.set_current(d_A=0.0, q_A=0.1, query=True)
        refused = (await shoulder.query()).values
        await shoulder.set_stop()
        return refused, (await shoulder.query()).values

    refused, after = talk(ask)
    assert refused[moteus.Register.MODE] == 1
    assert refused[moteus.Register.FAULT] == 36
    assert after[moteus.Register.MODE] == 0


def test_a_drive_with_other_gains_is_not_enabled(arm, tmp_path):
    """The driver compares what the maker's tool has changed."""
    other = tmp_path / "other.cfg"
    other.write_text("servo.pid_position.kp 4\n")
    tool("--restore-config", str(other))
    arm.start("controller")
    arm.start("driver")
    arm.until(
        lambda: "servo.pid_position.kp is 4, expected 4000" in arm.log("driver"),
        20,
        "the driver's refusal",
    )
    assert ROOT.exists()
