"""The simulated CiA 402 drive of the testbench, as somebody else's CANopen client sees it."""

from __future__ import annotations

import threading

import canopen
import pytest
from canopen.objectdictionary import ODRecord, ODVariable, datatypes
from canopen.profiles.p402 import BaseNode402

NODE = 1
PORT = 43113
U8, U16, U32 = datatypes.UNSIGNED8, datatypes.UNSIGNED16, datatypes.UNSIGNED32
I8, I16, I32 = datatypes.INTEGER8, datatypes.INTEGER16, datatypes.INTEGER32
REAL, TEXT = datatypes.REAL32, datatypes.VISIBLE_STRING
VARIABLES = {
    0x1000: U32,
    0x1008: TEXT,
    0x1017: U16,
    0x6007: I16,
    0x6040: U16,
    0x6041: U16,
    0x6060: I8,
    0x6061: I8,
    0x6064: I32,
    0x6071: I16,
    0x6076: U32,
    0x6077: I16,
    0x6403: TEXT,
    0x6502: U32,
}
COMMUNICATION = [U8, U32, U8, U16, None, U16]  # by subindex
RECORDS = {
    0x1400: COMMUNICATION,
    0x1600: [U8] + 8 * [U32],
    0x1800: COMMUNICATION,
    0x1A00: [U8] + 8 * [U32],
    0x2010: [U8, REAL, REAL, REAL, U32, U32],
    0x60E4: [U8, I32],
}


def variable(index: int, sub: int, data_type: int) -> ODVariable:
    entry = ODVariable(f"{index:04X}:{sub:02X}", index, sub)
    entry.data_type = data_type
    return entry


def dictionary() -> canopen.ObjectDictionary:
    objects = canopen.ObjectDictionary()
    objects.node_id = NODE
    for index, data_type in VARIABLES.items():
        objects.add_object(variable(index, 0, data_type))
    for index, members in RECORDS.items():
        record = ODRecord(f"{index:04X}", index)
        for sub, data_type in enumerate(members):
            if data_type is not None:
                record.add_member(variable(index, sub, data_type))
        objects.add_object(record)
    return objects


def multicast_group(name: str) -> str:
    """As drivers/can/virtual_bus.h says."""
    value = 2166136261
    for letter in name.encode():
        value = (value ^ letter) * 16777619 % 2**32
    value ^= value >> 16
    return f"239.74.{value >> 8 & 255}.{value & 255}"


@pytest.fixture
def drive(stack):
    """A client's view of the drive, pre-operational."""
    network = canopen.Network()
    network.connect(
        interface="udp_multicast",
        channel=multicast_group("testbench"),
        port=PORT,
        hop_limit=0,
        fd=True,
    )
    stack.robot = "testbench"
    node = network.add_node(BaseNode402(NODE, dictionary()))
    booted = threading.Event()
    node.nmt.add_heartbeat_callback(lambda state: booted.set() if state == 0 else None)
    stack.start("sim", "--realtime")
    assert booted.wait(timeout=20)
    yield node
    network.disconnect()


def enable(drive: BaseNode402) -> None:
    drive.op_mode = "CYCLIC SYNCHRONOUS TORQUE"
    assert drive.op_mode == "CYCLIC SYNCHRONOUS TORQUE"
    drive.state = "OPERATION ENABLED"
    assert drive.state == "OPERATION ENABLED"


def test_objects_are_read_and_written(drive):
    assert drive.sdo[0x1000].raw == 0x00020192
    assert drive.sdo[0x6076].raw == 6200  # mN m
    assert drive.sdo[0x2010][2].raw == pytest.approx(5000.0)
    drive.sdo[0x6007].raw = 2
    assert drive.sdo[0x6007].raw == 2
    drive.sdo[0x2010][1].raw = 1.5
    assert drive.sdo[0x2010][1].raw == pytest.approx(1.5)


def test_long_objects_travel_in_segments(drive):
    assert drive.sdo[0x1008].raw == "limber bench"
    drive.sdo[0x6403].raw = "a motor of another name"
    assert drive.sdo[0x6403].raw == "a motor of another name"


@pytest.mark.parametrize(
    "index, sub, data, code",
    [
        (0x6041, 0, b"\x01\x00", 0x06010002),  # read only
        (0x3000, 0, b"\x01", 0x06020000),  # no such object
        (0x2010, 9, b"\x01", 0x06090011),  # no such subindex
        (0x6060, 0, b"\x03", 0x06090030),  # profile velocity: not here
        (0x6007, 0, b"\x07\x00", 0x06090031),  # too high
        (0x6071, 0, b"\x01", 0x06070010),  # too short
    ],
)
def test_refusals(drive, index, sub, data, code):
    with pytest.raises(canopen.SdoAbortedError) as refusal:
        drive.sdo.download(index, sub, data)
    assert refusal.value.code == code


def test_heartbeats_follow_network_management(drive):
    drive.sdo[0x1017].raw = 20
    drive.nmt.wait_for_heartbeat(timeout=5)
    assert drive.nmt.state == "PRE-OPERATIONAL"
    drive.nmt.state = "OPERATIONAL"
    drive.nmt.wait_for_heartbeat(timeout=5)
    assert drive.nmt.state == "OPERATIONAL"


def test_walk_through_the_states(drive):
    assert drive.state == "SWITCH ON DISABLED"
    enable(drive)
    drive.state = "SWITCHED ON"
    assert drive.state == "SWITCHED ON"
    drive.state = "READY TO SWITCH ON"
    assert drive.state == "READY TO SWITCH ON"


def test_tpdo_answers_sync(drive):
    drive.tpdo.read()
    state = drive.tpdo[1]
    state.clear()
    state.add_variable(0x6041)
    state.add_variable(0x6064)
    state.add_variable(0x6077)
    state.trans_type = 1
    state.enabled = True
    state.save()
    drive.nmt.state = "OPERATIONAL"
    assert state.wait_for_reception(timeout=0.2) is None
    drive.network.sync.start(0.05)
    for _ in range(3):
        assert state.wait_for_reception(timeout=5) is not None
        assert state[0x6041].raw & 0x6F == 0x40
        assert state[0x6064].raw == 0
        assert state[0x6077].raw == 0
    drive.network.sync.stop()


def test_a_silent_master_is_a_fault(drive):
    drive.rpdo.read()
    command = drive.rpdo[1]
    command.clear()
    command.add_variable(0x6040)
    command.add_variable(0x6071)
    command.trans_type = 255
    command.event_timer = 500
    command.enabled = True
    command.save()
    enable(drive)
    drive.nmt.state = "OPERATIONAL"
    command[0x6040].raw = 0x000F
    command[0x6071].raw = 0
    command.transmit()
    assert drive.emcy.wait(0x8250, timeout=5) is not None
    while drive.state == "FAULT REACTION ACTIVE":  # in which a reset is too early
        pass
    assert drive.state == "FAULT"
    drive.sdo[0x6040].raw = 0
    drive.sdo[0x6040].raw = 0x80
    assert drive.state == "SWITCH ON DISABLED"
    assert drive.emcy.active == []
