"""Late cycles of the real processes with and without somebody who looks at the page, in one run.

    python -m limber_qa.bench_viewer [WINDOWS]

Windows of five seconds in turn, with one viewer and without: what else runs on the machine meets
both. A late cycle starts more than a tenth of a period after its time.
"""

import asyncio
import sys
import tempfile
import time
from contextlib import ExitStack, closing, suppress
from pathlib import Path

import msgspec
import viser
from websockets.asyncio.client import connect
from websockets.typing import Subprotocol

from limber.live.receiver import Receiver
from limber.model.robot import load_robot
from limber_qa.bench_page import CAMERA, monitor
from limber_qa.realtime_soak import PROGRAMS, started

ROBOT = "planar2r"
WINDOW_S = 5.0
WINDOWS = 12
COUNTS = ("cycles", "late_cycles", "overrun_cycles")


async def _look(address: str) -> None:
    protocol = Subprotocol(f"viser-v{viser.__version__}")
    async with connect(address, subprotocols=[protocol], max_size=None) as socket:
        await socket.send(msgspec.msgpack.encode(CAMERA))
        while True:
            await socket.recv()


def _window(looked: bool, address: str) -> None:
    if not looked:
        time.sleep(WINDOW_S)
        return
    with suppress(TimeoutError):
        asyncio.run(asyncio.wait_for(_look(address), WINDOW_S))


def main(windows: int) -> None:
    totals = {True: [0, 0, 0], False: [0, 0, 0]}
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        robot = load_robot(ROBOT)
        for name in PROGRAMS:
            child = stack.enter_context(started(name, robot, folder))
            stack.callback(child.terminate)
        page = stack.enter_context(monitor(ROBOT))
        receiver = stack.enter_context(closing(Receiver("DRIVER_STATUS")))
        newest = receiver.channels["DRIVER_STATUS"]
        if not receiver.wait_for(lambda: newest.count > 10, 20):
            raise SystemExit("the driver does not start")

        def counts() -> list[int]:
            status = receiver.newest("DRIVER_STATUS")
            assert status is not None
            return [int(status[name]) for name in COUNTS]

        for window in range(windows):
            looked = window % 2 == 0
            before = counts()
            _window(looked, page.address)
            gained = [b - a for a, b in zip(before, counts(), strict=True)]
            totals[looked] = [a + b for a, b in zip(totals[looked], gained, strict=True)]
    for looked, (cycles, late, overrun) in totals.items():
        who = "with a viewer" if looked else "without"
        print(f"{who:14} {cycles} cycles, {late} late ({late / cycles:.2%}), {overrun} overrun")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else WINDOWS)
