"""Black boxes, written here byte by byte as common/black_box does: order, seams, damage."""

import random
import struct

import lcm
import pytest

from limber.black_box import boxes
from limber.black_box.boxes import Record, kept_boxes, read, together, write_log
from limber.errors import InputError

EPOCH_us = 1_000_000_000


def header(text: str = "limber-black-box/1\nname: driver-x\n", epoch_us: int = EPOCH_us) -> bytes:
    text += f"epoch_minus_monotonic_ns: {epoch_us * 1000}\n"
    return text.encode().ljust(boxes.HEADER_BYTES, b"\0")


def record(number: int, channel: str = "A", data: bytes = b"data", time_us: int = 0) -> bytes:
    lengths = struct.pack(">ii", len(channel), len(data))
    whole = b"\xed\xa1\xda\x01" + struct.pack(">qq", number, time_us) + lengths
    whole += channel.encode() + data
    return whole + bytes(-len(whole) % 8)


def box(folder, ring: bytes, name: str = "20261122T101112-driver-x-driver.BUS.box"):
    path = folder / name
    path.write_bytes(header() + ring)
    return path


def test_records_come_in_the_order_of_their_numbers(tmp_path):
    """The ring went round: the newest records lie before the oldest."""
    path = box(tmp_path, record(7, "B", b"new", 9) + record(5, "A", b"old", 4) + bytes(64))
    assert read(path) == [
        Record(5, EPOCH_us + 4, "A", b"old"),
        Record(7, EPOCH_us + 9, "B", b"new"),
    ]


def test_a_record_that_was_overwritten_in_part_is_left_out(tmp_path):
    old = record(1, data=b"x" * 100)
    unfinished = bytearray(record(9))
    unfinished[:4] = bytes(4)  # its sync word is written last
    path = box(tmp_path, record(8) + old[len(record(8)) :] + bytes(unfinished) + record(2))
    assert [r.number for r in read(path)] == [2, 8]


@pytest.mark.parametrize(
    "damage",
    [
        record(3)[:30],  # the file ends
        record(3, "A" * 64),
        record(3, data=b"x" * 1401),
        record(3, channel=""),
        b"\xed\xa1\xda\x01" * 9,
    ],
)
def test_damage_hides_nothing_else(tmp_path, damage):
    whole = record(1)
    padded = damage + bytes(-len(damage) % 8)
    assert [r.number for r in read(box(tmp_path, whole + padded + whole))][:1] == [1]
    assert [r.number for r in read(box(tmp_path, whole + damage))] == [1]


def test_what_is_no_black_box_is_refused(tmp_path):
    for content in (b"", b"something else", header("limber-black-box/2\n")):
        path = tmp_path / "20261122T101112-driver-x-y.box"
        path.write_bytes(content)
        with pytest.raises(InputError, match="no black box"):
            read(path)


@pytest.mark.parametrize("seed", range(3))
def test_random_damage_never_invents_a_record_or_an_error(tmp_path, seed):
    """Whatever is changed, cut or inserted: what is read is bounded, whole records stay."""
    choose = random.Random(seed)
    whole = b"".join(record(n, data=bytes([n]) * (n % 40)) for n in range(60))
    for _ in range(300):
        ring = bytearray(whole)
        for _ in range(choose.randint(1, 6)):
            at = choose.randrange(len(ring))
            kind = choose.randrange(3)
            if kind == 0:
                ring[at] = choose.randrange(256)
            elif kind == 1:
                del ring[at:]
                ring += b"\0"
            else:
                ring[at:at] = choose.randbytes(choose.randint(1, 30))
        for found in read(box(tmp_path, bytes(ring))):
            assert 0 < len(found.channel) <= boxes.MAX_CHANNEL_BYTES
            assert len(found.data) <= boxes.MAX_MESSAGE_BYTES


def test_boxes_of_one_event_become_one_log(tmp_path, monkeypatch):
    monkeypatch.setenv("LIMBER_BLACK_BOXES", str(tmp_path))
    state = record(0, "JOINT_STATE", b"state", 10)
    box(tmp_path, state + record(1, "JOINT_TORQUE", b"torque", 30))
    box(
        tmp_path,
        record(0, "JOINT_STATE", b"state", 12) + record(1, "SIM_TRUTH", b"truth", 20),
        "20261122T101114-controller-x-controller.DRIVER_FAULT.box",
    )
    box(tmp_path, record(0), "20261122T101112-driver-other-driver.BUS.box")
    box(tmp_path, record(0), "20261122T111112-driver-x-driver.BUS.box")
    (tmp_path / "notes.box").write_text("not of limber")
    first = next(b for b in kept_boxes() if b.robot == "x")
    both = together(first, kept_boxes())
    assert [(b.program, b.code) for b in both if b.robot == "x"] == [
        ("driver", "driver.BUS"),
        ("controller", "controller.DRIVER_FAULT"),
    ]
    assert write_log(both, tmp_path / "log") == 3
    events = list(lcm.EventLog(str(tmp_path / "log")))
    assert [(e.channel, e.data) for e in events] == [
        ("JOINT_STATE", b"state"),
        ("SIM_TRUTH", b"truth"),
        ("JOINT_TORQUE", b"torque"),
    ]
    assert [e.timestamp - EPOCH_us for e in events] == [10, 20, 30]


def test_a_wall_clock_that_was_set_between_two_starts_changes_no_order(tmp_path, monkeypatch):
    """The controller was started anew an hour of wall clock later, at the same time."""
    monkeypatch.setenv("LIMBER_BLACK_BOXES", str(tmp_path))
    box(tmp_path, record(0, data=b"1st", time_us=10) + record(1, data=b"3rd", time_us=30))
    later = header(epoch_us=EPOCH_us + 3600 * 10**6) + record(0, data=b"2nd", time_us=20)
    (tmp_path / "20261122T101114-controller-x-controller.DRIVER_FAULT.box").write_bytes(later)
    assert write_log(kept_boxes(), tmp_path / "log") == 3
    events = list(lcm.EventLog(str(tmp_path / "log")))
    assert [e.data for e in events] == [b"1st", b"2nd", b"3rd"]
    assert [e.timestamp - EPOCH_us for e in events] == [10, 20, 30]
