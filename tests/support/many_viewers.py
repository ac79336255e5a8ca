"""Browsers without a screen: they read whatever viser sends, and draw nothing."""

import asyncio
import threading
from contextlib import contextmanager

import msgpack
import viser
from websockets.asyncio.client import connect

CAMERA = {
    "type": "ViewerCameraMessage",
    "wxyz": [1.0, 0.0, 0.0, 0.0],
    "position": [2.0, 0.0, 1.0],
    "fov": 1.3,
    "near": 0.01,
    "far": 1000.0,
    "image_height": 600,
    "image_width": 800,
    "look_at": [0.0, 0.0, 0.5],
    "up_direction": [0.0, 0.0, 1.0],
}


class Viewers:
    def __init__(self, port: int, count: int) -> None:
        self.read = [0] * count
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._run, args=(port, count), daemon=True)
        self._thread.start()

    def _run(self, port: int, count: int) -> None:
        asyncio.set_event_loop(self._loop)
        self._tasks = [self._loop.create_task(self._look(port, i)) for i in range(count)]
        self._loop.run_until_complete(asyncio.gather(*self._tasks, return_exceptions=True))

    async def _look(self, port: int, number: int) -> None:
        protocol = f"viser-v{viser.__version__}"
        address = f"ws://127.0.0.1:{port}"
        async with connect(address, subprotocols=[protocol], max_size=None) as socket:
            await socket.send(msgpack.packb(CAMERA))  # viser counts who has a camera
            async for _message in socket:
                self.read[number] += 1

    def close(self) -> None:
        for task in self._tasks:
            self._loop.call_soon_threadsafe(task.cancel)
        self._thread.join()


@contextmanager
def viewers(port: int, count: int):
    looking = Viewers(port, count)
    yield looking
    looking.close()
