"""Writes the first inputs of the fuzz targets from real frames, messages and files.

    .venv/bin/python tests/fuzz/make_corpus.py

Frames are those of short runs of the lab. Inputs that this script does not write, such as what a
fuzzer found and somebody kept (found-...), stay.
"""

import re
import struct
import subprocess
import tempfile
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import can
import lcm
from can.interfaces.udp_multicast.utils import pack_message

from limber import messages
from limber.paths import ROOT, program

CORPUS = ROOT / "tests" / "fuzz" / "corpus"
DATA = ROOT / "tests" / "robots" / "data"
FRAMES = 40  # of each part of a run: an input stays below two kilobytes
HEAR, HEAR_ANSWER, ACT = b"\1", b"\11", b"\0"
BEGIN_CYCLE = ACT + b"\0"


@dataclass(frozen=True)
class Frame:
    id: int
    extended: bool
    fd: bool
    data: bytes
    remote: bool = False

    def record(self) -> bytes:
        """As fuzz_input.h reads it."""
        flags = self.extended | self.remote << 1 | self.fd << 3
        return struct.pack("<BIB", flags, self.id, len(self.data)) + self.data


def parse(line: str) -> Frame:
    match = re.fullmatch(r"\(.*\) \S+ ([0-9A-F]+)#(#[0-9A-F])?(R?)([0-9A-F]*)", line)
    assert match, line
    data = bytes.fromhex(match[4])
    return Frame(int(match[1], 16), len(match[1]) > 3, bool(match[2]), data, bool(match[3]))


def run(scenario: str, folder: Path) -> tuple[list[str], Path]:
    """candump lines and LCM log of a shipped scenario."""
    frames, log = folder / f"{scenario}.candump", folder / f"{scenario}.lcmlog"
    path = ROOT / "scenarios" / f"{scenario}.yaml"
    command = [program("limber-lab"), path, "--can", frames, "--log", log]
    subprocess.run(list(map(str, command)), check=True, stderr=subprocess.DEVNULL)
    return frames.read_text(encoding="ascii").splitlines(), log


def keep(target: str, name: str, data: bytes) -> None:
    path = CORPUS / target / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data)


def of_first_motor(frames: Iterable[Frame], is_its: Callable[[int], bool]) -> list[Frame]:
    return [frame for frame in frames if is_its(frame.id)]


def moteus_first(id: int) -> bool:
    return id & 0x7F == 1 or id >> 8 & 0x7F == 1


ROBOTS: dict[str, tuple[str, Callable[[int], bool]]] = {
    "damiao": ("quick", lambda id: id in (0x01, 0x11, 0x7FF)),
    "moteus": ("planar2r_push", moteus_first),
    "cia402": ("panda_push", lambda id: id in (0, 0x80) or id & 0x7F == 1),
    "cubemars": ("desktop2r_ak_push", lambda id: id in (0x0, 0x01)),
    "odrive": ("desktop2r_odrive_push", lambda id: id >> 5 == 1),
    "myactuator": ("axol_push", lambda id: id in (0x141, 0x241, 0x401, 0x501)),
    "robstride": ("edulite_a3_push", lambda id: id & 0xFF == 1 or id & 0xFFFF == 0x1FD),
}


def motor_inputs(protocol: str, frames: list[Frame]) -> None:
    start, motion = frames[:FRAMES], frames[len(frames) // 2 :][:FRAMES]
    for name, part in (("start", start), ("motion", motion)):
        heard = b"".join(HEAR + frame.record() + BEGIN_CYCLE for frame in part)
        keep(f"drive_{protocol}", name, heard)
        time_passes = b"\0" + struct.pack("<H7h", 1000, 10, 20, 10, 20, 30, 40, 50)
        received = b"".join(HEAR + frame.record() + time_passes for frame in part)
        keep(f"node_{protocol}", name, received)
    dialogue = b"".join(
        HEAR_ANSWER + frame.record() + bytes([step]) for step, frame in enumerate(start)
    )
    keep(f"drive_{protocol}", "dialogue", dialogue)
    both = b"".join(HEAR + f.record() + BEGIN_CYCLE for f in start) + heard
    keep(f"drive_{protocol}", "whole", both)


def bus_inputs(protocol: str, lines: list[str], frames: list[Frame]) -> None:
    keep("candump_log", f"{protocol}.log", "\n".join([*lines[:12], *lines[-4:], ""]).encode())
    for number, frame in enumerate(frames[:3]):
        message = can.Message(
            arbitration_id=frame.id,
            is_extended_id=frame.extended,
            is_fd=frame.fd,
            is_remote_frame=frame.remote,
            data=frame.data,
            timestamp=1.5,
        )
        keep("virtual_frame", f"{protocol}{number}", pack_message(message))


def sdo_inputs(frames: list[Frame]) -> None:
    sdo = [frame for frame in frames if frame.id & 0x780 in (0x580, 0x600)]
    node = bytes([0])  # node 1
    keep("canopen_sdo", "startup", b"".join(node + frame.record() for frame in sdo[:FRAMES]))
    segments = ["601#2100200014000000", "581#6000200000000000", "601#0061626364656667"]
    segments += ["581#2000000000000000", "601#1D68000000000000", "581#8000200000000406"]
    records = (node + parse(f"(0) can0 {text}").record() for text in segments)
    keep("canopen_sdo", "segments", b"".join(records))


def sensor_inputs() -> None:
    def frame(id: int, data: bytes, fd: bool = False) -> bytes:
        return HEAR + Frame(id, False, fd, data).record()

    halves = struct.pack(">B6hB2x", 0x0A, 100, -200, 300, 40, -50, 60, 0)
    begin = b"\4"
    request = frame(0x64, b"\x0a".ljust(8, b"\0"))
    reply = frame(0x65, halves[:8]) + frame(0x66, halves[8:])
    keep("tip_sensor", "robotous", (begin + request + reply) * 4)
    own = b"".join(
        begin
        + frame(0x64, bytes([0x0A, n]), True)
        + frame(0x65, struct.pack("<4B6f4x", 0x0A, n, 0, 0, 1, 2, 3, 0.1, 0.2, 0.3), True)
        for n in range(1, 5)
    )
    keep("tip_sensor", "limber", own)


def black_box_inputs() -> None:
    messages_of_a_cycle = b"".join(struct.pack("<BH", 11, size) for size in (60, 80, 400)) * 8
    for ring in (1023, 4095):
        keep("black_box", f"ring_{ring}", struct.pack("<H", ring) + messages_of_a_cycle)


def shared_memory_inputs() -> None:
    """An action with a length, then what it needs; see shared_memory.cc."""

    def action(kind: int, length: int = 0) -> bytes:
        return struct.pack("<BH", kind, length)

    def spoil(ring: int, what: int, slot: int, data: bytes) -> bytes:
        return action(4) + bytes([ring + 2 * what, slot]) + data

    receive, wait, send, write = (action(kind, 400) for kind in range(4))
    keep("shared_memory", "both_ways", b"\1" + (write + wait + receive + send) * 8)
    keep("shared_memory", "overtaken", b"\0" + write * 70 + receive * 3 + wait)
    number, size = struct.pack("<bI", 0, 2**31), struct.pack("<bI", 0, 2**32 - 1)
    spoilt = spoil(1, 0, 0, number) + receive + spoil(1, 2, 1, size) + write + receive
    keep("shared_memory", "spoilt", b"\1" + write + spoilt + spoil(1, 1, 2, b"\2") + wait)
    torn = spoil(1, 1, 1, b"\100") + receive + spoil(1, 4, 1, b"\3" + bytes(8)) + receive
    keep("shared_memory", "torn", b"\1" + write * 3 + torn)


def fragment_inputs() -> None:
    """As lcm_fragments.cc reads them: kind and sender, five numbers, length, data."""

    def fragment(sender: int, offset: int, number: int, data: bytes) -> bytes:
        return bytes([sender, 1, 10, offset, number, 3, len(data)]) + data

    parts = [(0, 0, b"ARM\0abcd"), (4, 1, b"efgh"), (8, 2, b"ij")]
    keep("lcm_fragments", "in_order", b"".join(fragment(0, *part) for part in parts))
    both = (fragment(sender, *part) for part in parts[::-1] for sender in (1, 2))
    keep("lcm_fragments", "two_senders", b"".join(both))
    large = struct.pack("<BIBIBIBIBIBB", 60, 1, 0, 1 << 20, 0, 5, 0, 1, 0, 300, 0, 1) + b"x"
    keep("lcm_fragments", "large", large * 3 + fragment(0, *parts[0]))


def lockstep_inputs() -> None:
    frames = [
        Frame(0x1FFFFFF0 + kind, True, False, struct.pack("<q", number))
        for number in (0, 1, 2**40, -1)
        for kind in (0, 1)
    ]
    keep("lockstep_frame", "tick_tock", b"".join(frame.record() for frame in frames))


def gate_inputs() -> None:
    cycle, command, powered = b"\x04", b"\x02", b"\x01\x03" + bytes(6)
    keep("torque_gate", "accepted", powered + (cycle + command) * 10)
    steps = b"".join(cycle + b"\x06\x03" + struct.pack("<h", 400) for _ in range(20))
    keep("torque_gate", "rising", powered + steps)
    fast = b"\x01\x03" + struct.pack("<3h", 9000, 9000, 9000)
    keep("torque_gate", "fast", powered + steps + fast + steps)
    spoils = [bytes([0x06, which]) + bytes([0x7F] * 8) for which in range(12)]
    keep("torque_gate", "spoilt", powered + b"".join(cycle + spoil for spoil in spoils))
    keep("torque_gate", "lease", powered + command + b"\x54" + cycle + command + b"\x44" + command)


def patches(*changes: tuple[int, bytes]) -> bytes:
    """As patched_message.h reads them; offsets count from behind the fingerprint."""
    parts = (struct.pack("<HB", at, len(data) - 1) + data for at, data in changes)
    return bytes([len(changes)]) + b"".join(parts)


def behind_fingerprint(data: bytes) -> bytes:
    return data[8:]


def on_any_machine(type_name: str, data: bytes) -> bytes:
    """ROBOT_INFO names a folder of the machine that recorded it."""
    if type_name != "robot_info_t":
        return data
    info = messages.decode(type_name, data)
    info.folder = f"/{Path(info.folder).relative_to(ROOT)}"
    return info.encode()


def message_inputs(logs: list[Path]) -> None:
    names = sorted(path.stem for path in (ROOT / "lcmtypes").glob("*.lcm"))
    for number, name in enumerate(names):
        keep(
            "messages",
            name,
            bytes([number]) + behind_fingerprint(messages.message_class(name)().encode()),
        )
    mark = messages.message_class("episode_mark_t")()
    mark.seq, mark.episode, mark.task = 3, 2, "pick the block"
    number = bytes([names.index("episode_mark_t")])
    keep("messages", "episode_mark_t-task", number + behind_fingerprint(mark.encode()))
    for log in logs:
        for channel, data in last_of_each_channel(log):
            row = messages.channels().get(channel)
            if row:
                data = on_any_machine(row.type_name, data)
                kind = names.index(row.type_name)
                keep(
                    "messages",
                    f"{row.type_name}-{log.stem}",
                    bytes([kind]) + behind_fingerprint(data),
                )
    half = struct.pack(">d", 0.5)
    nan = struct.pack(">d", float("nan"))
    tau = 36  # of joint_command_t, behind its fingerprint
    keep("joint_command", "held", bytes([0, 0] * 20))
    keep("joint_command", "torque", (b"\0" + patches((tau, half))) * 10)
    keep("joint_command", "nan", (b"\0" + patches((tau, nan), (tau + 256, nan))) * 4)
    keep("joint_command", "fallback", b"\0\0" + b"\x0c\0" * 5 + b"\x10\0" + b"\x08\0" * 9)
    q = 36  # of joint_state_t
    keep("joint_state", "steady", bytes([8 * 7, 0] * 6))
    keep("joint_state", "moving", b"".join(b"\0" + patches((q, half)) for _ in range(6)))
    keep("joint_state", "nan", b"\0" + patches((q, nan)) + bytes([8 * 7, 0]))
    requests = b"".join(bytes([8 + kind]) + patches((20, half)) for kind in (4, 5, 6, 7))
    keep("joint_state", "requests", requests * 2)


def stream_inputs() -> None:
    """As streams.cc reads them: type and cycles, patches. Offsets are those of the messages."""

    def message(kind: int, *changes: tuple[int, bytes], cycles: int = 31) -> bytes:
        return bytes([8 * cycles + kind]) + patches(*changes)

    joints, pose, twist, overlay = 0, 1, 2, 6
    t0, delay, knots, dt, value, tau = 32, 40, 50, 52, 116, 33
    near, far, much = (struct.pack(">f", x) for x in (0.3, 0.5, 1e30))
    nan = struct.pack(">f", float("nan"))
    for name, kind in (("joints", joints), ("pose", pose), ("twist", twist)):
        followed = message(kind) * 4
        jumps = message(kind, (value, near), (value + 64, far)) * 3
        keep("streams", name, followed + jumps + message(kind, (knots, b"\x10"), (delay, bytes(4))))
    spoilt = [(value, nan), (value, much), (dt + 4, bytes(4)), (knots, b"\x11"), (delay, much)]
    spoilt += [(t0, bytes(8)), (t0, b"\x7f" + bytes(7)), (t0, b"\xff" * 8)]
    keep("streams", "spoilt", b"".join(message(joints, change, cycles=3) for change in spoilt))
    flood = message(joints, cycles=0) + message(pose, cycles=0) + message(twist, cycles=0)
    keep("streams", "flood", flood * 10)
    on_top = message(overlay, (tau, near), cycles=5)
    keep("streams", "overlay", message(joints) + on_top * 6 + message(overlay, (tau, much)))


def last_of_each_channel(log: Path) -> Iterator[tuple[str, bytes]]:
    found: dict[str, bytes] = {}
    for event in lcm.EventLog(str(log)):
        found[event.channel] = event.data
    yield from found.items()


def file_inputs() -> None:
    keep("urdf", "arm.urdf", (DATA / "arm" / "robot.urdf").read_bytes())
    for name in ("arm", "chain", "moteus"):
        text = (DATA / name / "robot.yaml").read_text(encoding="utf-8")
        keep("robot_yaml", f"{name}.yaml", text.replace("../arm/", "").encode())
    for name in ("good", "laws"):
        path = ROOT / "tests" / "scenarios" / "data" / f"{name}.yaml"
        keep("scenario", f"{name}.yaml", path.read_bytes())
    for name, inputs in {
        "kin_dyn": '{"q": [0.5, 1.0], "W": [40, 0]}',
        "joint_pd": '{"q": [0.1, 0.2], "v": [0, 0], "q_d": [0, 0], "v_d": [0, 0],'
        ' "Kp": [10, 10], "Kv": [[1, 0], [0, 1]], "bias": "gravity"}',
        "tank": '{"E0": 1, "Emax": 2, "Emin": 0.5, "share": 1, "D": 1, "T": 1e-3,'
        ' "K_req": [1, 2], "e": [0, 0], "V": [0, 0]}',
    }.items():
        keep("eval_json", f"{name}.json", f'{{"law": "{name}", "in": {inputs}}}'.encode())


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        logs = []
        for protocol, (scenario, is_its) in ROBOTS.items():
            lines, log = run(scenario, Path(folder))
            frames = [parse(line) for line in lines]
            motor_inputs(protocol, of_first_motor(frames, is_its))
            bus_inputs(protocol, lines, frames)
            logs.append(log)
            if protocol == "cia402":
                sdo_inputs(frames)
        message_inputs(logs)
    stream_inputs()
    sensor_inputs()
    black_box_inputs()
    shared_memory_inputs()
    fragment_inputs()
    lockstep_inputs()
    gate_inputs()
    file_inputs()


if __name__ == "__main__":
    main()
