"""What the page costs and how fresh it is, with one viewer and no drawing in a browser.

    python -m limber_qa.bench_page [SECONDS]

JOINT_STATE and CONTROLLER_STATUS come at 1 kHz each from another process, in which the first joint
jumps every half second. `limber monitor` serves them; a viewer takes what a browser would take and
notes when the jump arrives. Then the messages stop, and the viewer notes when the page
tells. Processor time of the serving process, not wall time.
"""

import asyncio
import os
import subprocess
import sys
import time
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass
from pathlib import Path

import lcm
import msgspec
import numpy as np
import viser
import zstandard
from websockets.asyncio.client import ClientConnection, connect
from websockets.typing import Subprotocol

from limber import messages
from limber.model.robot import load_robot

ROBOT = "panda"
RATE_HZ = 1000
FLIP_S = 0.5
SECONDS = 20.0
JUMP_RAD = 0.3
GIVE_UP_S = 20.0
CAMERA = {
    "type": "ViewerCameraMessage",
    "wxyz": (1.0, 0.0, 0.0, 0.0),
    "position": (2.0, 0.0, 1.0),
    "fov": 1.3,
    "near": 0.01,
    "far": 100.0,
    "image_height": 600,
    "image_width": 800,
    "look_at": (0.0, 0.0, 0.0),
    "up_direction": (0.0, 0.0, 1.0),
}
DEAD = b"What is shown is old"  # words.py


def publish(seconds: float) -> None:
    """Both channels; the joint's position follows the clock: everybody knows when it jumps."""
    line = lcm.LCM(messages.user_plane_url())
    state = messages.message_class("joint_state_t")()
    status = messages.message_class("controller_status_t")()
    robot = load_robot(ROBOT)
    n = len(robot.joints)
    state.num_joints = status.num_joints = n
    state.period_ns = 1_000_000_000 // RATE_HZ
    state.session = status.session = 1
    state.drive_state, status.mode = state.DRIVE_ON, status.MODE_HOLD
    state.joint_flags[:n] = [state.JOINT_FRESH] * n
    status.quat_BT = status.quat_BD = [1.0, 0.0, 0.0, 0.0]
    begun = due = time.monotonic()
    while due < begun + seconds:
        state.seq += 1
        status.seq += 1
        state.time_ns = status.time_ns = state.seq * state.period_ns
        jumped = int(time.monotonic() / FLIP_S) % 2
        state.q[:n] = robot.home
        state.q[0] += JUMP_RAD * jumped
        line.publish("JOINT_STATE", state.encode())
        line.publish("CONTROLLER_STATUS", status.encode())
        due += 1.0 / RATE_HZ
        time.sleep(max(0.0, due - time.monotonic()))
    print(time.monotonic())


def _content(window: bytes) -> bytes:
    """The packed messages of one window of viser's stream."""
    size = int.from_bytes(window[8:16], "little")
    return zstandard.ZstdDecompressor().decompress(window[16 : 16 + size])


@asynccontextmanager
async def viewer(address: str) -> AsyncIterator[ClientConnection]:
    """What a browser would be: windows of messages come."""
    protocol = Subprotocol(f"viser-v{viser.__version__}")
    async with connect(address, subprotocols=[protocol], max_size=None) as socket:
        await socket.send(msgspec.msgpack.encode(CAMERA))  # a viewer counts once it has one
        yield socket


async def view(address: str, joint: str) -> tuple[list[float], float]:
    """Seconds from each jump to its arrival; when the page told that nothing comes any more."""
    latencies: list[float] = []
    shown = None
    async with viewer(address) as socket:
        while True:
            window = await asyncio.wait_for(socket.recv(), GIVE_UP_S)
            assert isinstance(window, bytes)
            content = _content(window)
            now = time.monotonic()
            if latencies and DEAD in content:
                return latencies, now
            pose = _pose(content, joint)
            if pose is not None and shown is not None and abs(pose - shown).max() > 0.01:
                latencies.append(now % FLIP_S)
            shown = shown if pose is None else pose


def _pose(content: bytes, joint: str) -> np.ndarray | None:
    """The newest orientation of the joint's link in the arm as measured."""
    found = None
    for message in msgspec.msgpack.decode(content)["messages"]:
        if message["type"] == "SetOrientationMessage" and message["name"].endswith(joint):
            found = found if "ghost" in message["name"] else np.array(message["wxyz"])
    return found


def _processor_s(process: int) -> float:
    """Of all its threads, user and system time."""
    fields = Path(f"/proc/{process}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@dataclass
class Monitor:
    """`limber monitor` and, once it has ended, its last line."""

    process: subprocess.Popen[str]
    address: str
    last_line: str = ""


@contextmanager
def monitor(robot: str) -> Iterator[Monitor]:
    command = [sys.executable, "-m", "limber", "monitor", "--robot", robot]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    served = Monitor(process, process.stdout.readline().split()[0].replace("http", "ws"))
    try:
        yield served
    finally:
        process.terminate()
        told, _ = process.communicate(timeout=20)
        served.last_line = told.strip().splitlines()[-1]


def main(seconds: float) -> None:
    own = [sys.executable, "-m", "limber_qa.bench_page", "publish", str(seconds)]
    with monitor(ROBOT) as page:
        begun, cost = time.monotonic(), _processor_s(page.process.pid)
        publisher = subprocess.Popen(own, stdout=subprocess.PIPE, text=True)
        joint = load_robot(ROBOT).chain.joints[0].child
        latencies, told_s = asyncio.run(view(page.address, joint))
        assert publisher.stdout is not None
        dead_s = told_s - float(publisher.stdout.read())
        lasted, end = time.monotonic() - begun, _processor_s(page.process.pid)
    p50, p99 = np.quantile(latencies, [0.5, 0.99]) * 1e3
    print(f"{lasted:.0f} s with one viewer: {100 * (end - cost) / lasted:.0f} % of a core")
    print(
        f"{len(latencies)} jumps: shown after {p50:.0f} ms (median), {p99:.0f} ms (99 %), "
        f"{1e3 * max(latencies):.0f} ms at most"
    )
    print(f"the end of the messages is told after {dead_s:.2f} s")
    print(page.last_line)


if __name__ == "__main__":
    if sys.argv[1:2] == ["publish"]:
        publish(float(sys.argv[2]))
    else:
        main(float(sys.argv[1]) if len(sys.argv) > 1 else SECONDS)
