"""The simulated RobStride motors, as their maker's own package sees them."""

from __future__ import annotations

import time

import can
import pytest
from local_drive import multicast_group
from robstride_dynamics import Motor, ParameterType, RobstrideBus

JOINTS = {f"joint{number}": Motor(number, "rs-00") for number in range(1, 7)}


class Client(RobstrideBus):
    """As it is, but for the bus: the package opens SocketCAN only."""

    def connect(self, handshake: bool = True) -> None:
        group = multicast_group("edulite_a3")
        self.channel_handler = can.Bus(interface="udp_multicast", channel=group, hop_limit=0)

    def transmit(self, kind, extra_data, device_id, data=bytes(8)):
        """NumPy's integers, which SocketCAN takes and a datagram does not."""
        super().transmit(kind, int(extra_data), device_id, data)

    def receive(self, timeout=None):
        """Its own frames come back from a multicast group; none is for a host."""
        while True:
            answer = super().receive(timeout)
            if answer is None or answer[2] > 0x7F:
                return answer


@pytest.fixture
def client(stack):
    stack.robot = "edulite_a3"
    stack.start("sim", "--realtime")
    stack.until(lambda: stack.truth is not None, 20, "the simulator")
    made = Client("", JOINTS)
    made.connect()
    yield made
    made.disconnect()


def test_it_finds_and_reads(client):
    number, unique = client.ping_by_id(3, 1.0)
    assert number == 3 and len(unique) == 8
    assert client.read("joint2", ParameterType.VBUS) == 48.0
    assert client.read("joint2", ParameterType.MECHANICAL_POSITION) == pytest.approx(1.2, abs=1e-3)
    client.write("joint2", ParameterType.CAN_TIMEOUT, 400)
    assert client.read("joint2", ParameterType.CAN_TIMEOUT) == 400


def test_it_moves_a_joint(client, stack):
    """The first joint counts the other way; positions and gains of all models have one scale."""
    for name in JOINTS:  # the arm lies in its stand until all are enabled
        client.enable(name)
    others = {name: client.read(name, ParameterType.MECHANICAL_POSITION) for name in JOINTS}
    end = time.monotonic() + 30.0
    while not abs(stack.truth.q[0] + 0.3) < 0.02 and time.monotonic() < end:
        for name, position in others.items():
            wanted = position + 0.3 if name == "joint1" else position
            client.write_operation_frame(name, wanted, kp=60.0, kd=2.0)
            position_rad, *_, temperature_degC = client.read_operation_frame(name)
        assert temperature_degC == pytest.approx(30.0)
        time.sleep(0.005)
    assert stack.truth.q[0] == pytest.approx(-0.3, abs=0.02)
    client.write_operation_frame("joint1", others["joint1"] + 0.3, kp=60.0, kd=2.0)
    position_rad, *_ = client.read_operation_frame("joint1")
    assert position_rad == pytest.approx(0.3, abs=0.03)
