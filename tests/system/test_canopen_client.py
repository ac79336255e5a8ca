"""The simulated CiA 402 drive of the testbench, as somebody else's CANopen client sees it."""

from __future__ import annotations

import threading
from pathlib import Path

import canopen
import pytest
import yaml
from canopen.objectdictionary import datatypes
from canopen.profiles.p402 import BaseNode402
from local_drive import bus, multicast_group

from stack import ROOT

NODE = 1
PORT = 43113
AREAS = [*range(0x1000, 0x2100), *range(0x6000, 0x6800)]  # where the drive may have objects
TESTBENCH = ROOT / "robots" / "testbench"
EDS = str(TESTBENCH / "drive.eds")


def classic_testbench(folder: Path) -> str:
    """The testbench with a drive on classic CAN, 8 bytes a frame."""
    robot = yaml.safe_load((TESTBENCH / "robot.yaml").read_text(encoding="utf-8"))
    robot["urdf"] = str(TESTBENCH / "robot.urdf")
    robot["buses"] = [{"name": "arm", "can": "virtual:testbench", "bitrate_bps": 1000000}]
    (folder / "robot.yaml").write_text(yaml.safe_dump(robot), encoding="utf-8")
    return str(folder)


@pytest.fixture(params=["fd", "classic"])
def drive(stack, request, tmp_path):
    """A client's view of the drive, pre-operational."""
    fd = request.param == "fd"
    stack.robot = "testbench" if fd else classic_testbench(tmp_path)
    network = bus(PORT, multicast_group("testbench"), fd=fd)
    node = network.add_node(BaseNode402(NODE, canopen.import_od(EDS, NODE)))
    booted = threading.Event()
    node.nmt.add_heartbeat_callback(lambda state: booted.set() if state == 0 else None)
    stack.start("sim", "--realtime")
    assert booted.wait(timeout=300)
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


def test_the_eds_is_what_the_drive_serves(drive):
    """Every object of the shipped EDS is there, as long, as writable and with that value."""
    for entry in variables(drive.object_dictionary):
        data = drive.sdo.upload(entry.index, entry.subindex)
        if entry.data_type in datatypes.NUMBER_TYPES:
            assert 8 * len(data) == len(entry), entry.name
        if entry.default is not None:
            assert entry.decode_raw(data) == entry.default, entry.name
        if not entry.writable:
            with pytest.raises(canopen.SdoAbortedError) as refusal:
                drive.sdo.download(entry.index, entry.subindex, data)
            assert refusal.value.code == 0x06010002, entry.name


def test_the_eds_leaves_nothing_out(drive):
    known = {(entry.index, entry.subindex) for entry in variables(drive.object_dictionary)}
    served = set()
    for index in AREAS:
        subs = range(0x20) if (index, 1) in known else range(1)
        served |= {(index, sub) for sub in subs if is_served(drive, index, sub)}
    assert served == known


def variables(objects: canopen.ObjectDictionary) -> list[canopen.objectdictionary.ODVariable]:
    nested = (
        [entry] if isinstance(entry, canopen.objectdictionary.ODVariable) else entry.values()
        for index, entry in objects.items()
        if index >= 0x1000  # below are types for gaps in PDOs
    )
    return [variable for entries in nested for variable in entries]


def is_served(drive: BaseNode402, index: int, sub: int) -> bool:
    try:
        drive.sdo.upload(index, sub)
    except canopen.SdoAbortedError:
        return False
    return True
