"""LeRobot's own OpenArm and its Damiao bus, as they are, on the emulated drives."""

import re
import sys
import time

import can
import numpy as np
import pytest
from commands import ARM, ended, lerobot
from local_drive import multicast_group

from limber.paths import ROOT

GROUP = multicast_group(ARM)
MOTORS = range(1, 9)
RANGE_RAD = 12.5  # robot.yaml
READ_ALL = """
import sys
from lerobot.motors import Motor, MotorNormMode
from lerobot.motors.damiao import DamiaoMotorsBus

motor = Motor(8, "dm4310", MotorNormMode.DEGREES)
motor.recv_id, motor.motor_type_str = 0x18, "dm4310"
bus = DamiaoMotorsBus(sys.argv[1], {"gripper": motor}, can_interface="udp_multicast")
bus.connect()
bus.disable_torque()
bus.set_zero_position()
print(*(bus.read(name, "gripper") for name in ("Present_Position", "Temperature_MOS")))
bus.disconnect()
"""


@pytest.fixture
def bus(python):
    join = {"interface": "udp_multicast", "channel": GROUP, "hop_limit": 0, "fd": True}
    with ended([sys.executable, "-m", "limber", "sim", ARM]), can.Bus(**join) as found:
        end = time.monotonic() + 60.0
        while state(found, 1) is None:
            assert time.monotonic() < end, "no drive answers"
        yield found


def state(bus, motor):
    """Its error nibble and its angle in degrees; None without an answer."""
    while bus.recv(0.0) is not None:
        pass  # what others were answered
    request = bytes([motor, 0, 0xCC, 0, 0, 0, 0, 0])
    bus.send(can.Message(arbitration_id=0x7FF, is_extended_id=False, data=request, is_fd=True))
    end = time.monotonic() + 1.0
    while (left := end - time.monotonic()) > 0:
        answer = bus.recv(left)
        if answer is not None and answer.arbitration_id == 0x10 + motor:
            counts = int.from_bytes(answer.data[1:3], "big")
            return answer.data[0] >> 4, np.degrees((counts / 65535 * 2 - 1) * RANGE_RAD)
    return None


def test_the_example(python, bus, home):
    before = {motor: state(bus, motor)[1] for motor in MOTORS}
    enabled = set()

    def look():
        time.sleep(0.2)
        seen = [state(bus, motor) for motor in (4, 8)]
        enabled.add(all(one is not None and one[0] == 1 for one in seen))

    example = ROOT / "examples" / "lerobot" / "openarm_follower.py"
    said = lerobot(python, home, example, GROUP, meanwhile=look)
    elbow, gripper = (
        [float(x) for x in re.search(rf"{key}.pos: from (\S+) to (\S+) deg", said).groups()]
        for key in ("joint_4", "gripper")
    )
    assert elbow[0] == pytest.approx(before[4], abs=0.1)
    assert gripper[0] == pytest.approx(before[8], abs=0.1)
    # Its gains, 240 N m/rad, carry the forearm (about 4 N m), and nothing else does: 1 degree.
    assert elbow[1] - elbow[0] == pytest.approx(14, abs=1.5)
    assert gripper[1] - gripper[0] == pytest.approx(22.5, abs=1.5)
    assert True in enabled
    assert [state(bus, motor)[0] for motor in MOTORS] == [0] * 8, "all disabled at the end"


def test_the_damiao_bus_alone(python, bus, home):
    """Its enabling handshake, a zero, a reading."""
    position, temperature = lerobot(python, home, "-c", READ_ALL, GROUP).split()[-2:]
    assert float(position) == pytest.approx(0.0, abs=0.05)
    assert float(temperature) > 20
    assert state(bus, 8) == (0, pytest.approx(0.0, abs=0.05))


def test_lerobot_calibrate(python, bus, home):
    """The present pose becomes the zero."""
    words = ["--robot.type=openarm_follower", "--robot.id=sim", f"--robot.port={GROUP}"]
    lerobot(python, home, "lerobot-calibrate", *words, "--robot.can_interface=udp_multicast")
    assert (home / "calibration" / "robots" / "openarm_follower" / "sim.json").exists()
    zeros = [state(bus, motor) for motor in MOTORS]
    assert zeros == [(0, pytest.approx(0.0, abs=0.1))] * 8
