"""The simulated ODrive axes, as somebody else's package for them sees them."""

from __future__ import annotations

import asyncio

import can
import pytest
from local_drive import multicast_group
from odrive_can.odrive import ODriveCAN


@pytest.fixture
def axis(stack):
    """Makes a client of one axis, each on a bus of its own."""
    stack.robot = "desktop2r_odrive"
    stack.start("sim", "--realtime")
    stack.until(lambda: stack.truth is not None, 20, "the simulator")
    group = multicast_group("desktop2r_odrive")
    buses = []

    def client(node: int) -> ODriveCAN:
        buses.append(can.Bus(interface="udp_multicast", channel=group, hop_limit=0))
        made = ODriveCAN(node, buses[-1])
        made.turns = []  # of its estimates, which come by themselves
        made.feedback_callback = lambda message, it: it.turns.append(message.data["Pos_Estimate"])
        return made

    yield client
    for bus in buses:
        bus.shutdown()


def test_it_reads(axis):
    async def read() -> None:
        drive = axis(2)
        await asyncio.wait_for(drive.start(), 10)
        assert drive.axis_state == "IDLE"
        drive.check_errors()
        assert (await drive.get_bus_voltage_current())["Bus_Voltage"] == 48.0
        version = await drive._request("Get_Version")
        numbers = [version[f"Fw_Version_{part}"] for part in ("Major", "Minor", "Revision")]
        assert numbers == [0, 6, 11]
        errors = await drive._request("Get_Error")
        assert [str(value) for value in errors.values()] == ["NONE", "NONE"]
        assert drive.turns[-1] == pytest.approx(1.4 * 8 / 6.283185, abs=1e-3)
        drive.stop()

    asyncio.run(read())


def test_it_moves_a_joint(axis, stack):
    """The arm lies in its stand until both axes are in closed loop; it pushes the elbow up."""

    async def push() -> None:
        drives = [axis(node) for node in (1, 2)]
        for drive in drives:
            await asyncio.wait_for(drive.start(), 10)
            drive.set_controller_mode("TORQUE_CONTROL", "PASSTHROUGH")
            drive.set_limits(30.0, 30.0)
            await drive.set_axis_state("CLOSED_LOOP_CONTROL")
        before = drives[1].turns[-1]
        drives[1].set_input_torque(0.6)
        torques = await drives[1]._request("Get_Torques")
        assert torques["Torque_Target"] == pytest.approx(0.6)
        await asyncio.sleep(1.0)
        assert drives[1].turns[-1] > before + 0.2
        for drive in drives:
            drive.stop()

    asyncio.run(push())
    assert stack.truth.q[1] > 1.5
