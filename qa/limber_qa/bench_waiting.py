"""How long a person waits, beside a bare program of the same kind.

    python -m limber_qa.bench_waiting

By the clock, median of REPEATS, own and peers in turns.
"""

import asyncio
import json
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from importlib.util import find_spec

from limber_qa.bench_figure import Figure
from limber_qa.bench_page import GIVE_UP_S, viewer

REPEATS = 7
LIMBER = [sys.executable, "-m", "limber"]
PLAIN = [sys.executable, "-c", "pass"]
PYPLOT = "matplotlib.pyplot"
# A page of viser with nothing but a frame, as a script of four lines.
BARE_PAGE = """
import time, viser
server = viser.ViserServer(port=0, verbose=False)
server.scene.add_frame("/base")
print(f"http://localhost:{server.get_port()}", flush=True)
time.sleep(60)
"""


def importing(package: str) -> list[str]:
    return [sys.executable, "-c", f"import {package}"]


def ended(command: list[str], folder: str) -> float:
    """s, until it ends."""
    begun = time.monotonic()
    subprocess.run(command, cwd=folder, check=True, capture_output=True)
    return time.monotonic() - begun


def first_picture(command: list[str], folder: str) -> float:
    """s, until a viewer has its first messages; the command prints the page's address."""
    begun = time.monotonic()
    with subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            told = next(line for line in process.stdout if line.startswith("http"))
            asyncio.run(_first_messages(told.split()[0].replace("http", "ws")))
            return time.monotonic() - begun
        finally:
            process.terminate()


async def _first_messages(address: str) -> None:
    async with viewer(address) as socket:
        await asyncio.wait_for(socket.recv(), GIVE_UP_S)


def figures(folder: str) -> list[Figure]:
    """In an empty folder."""
    mujoco = importing("mujoco") if find_spec("mujoco") else None

    def beside(
        name: str,
        own: list[str],
        peer: str,
        peers: list[str] | None,
        wait: Callable[[list[str], str], float] = ended,
    ) -> Figure:
        taken: list[float] = []
        theirs: list[float] = []
        for _ in range(REPEATS):
            taken.append(wait(own, folder))
            if peers:
                theirs.append(wait(peers, folder))
        median = statistics.median(theirs) if theirs else None
        return Figure(f"wait for {name}", statistics.median(taken), peer, median, unit="s")

    ended([*LIMBER, "lab", "quick", "--out", "log"], folder)
    page, bare = [*LIMBER, "monitor", "--robot", "openarm"], [sys.executable, "-c", BARE_PAGE]
    return [
        beside("limber --help", [*LIMBER, "--help"], "python -c pass", PLAIN),
        beside("import limber", importing("limber"), "import numpy", importing("numpy")),
        beside("limber check openarm", [*LIMBER, "check", "openarm"], "import mujoco", mujoco),
        beside("limber lab quick", [*LIMBER, "lab", "quick"], "import mujoco", mujoco),
        beside("limber plot", [*LIMBER, "plot", "log"], "import matplotlib", importing(PYPLOT)),
        beside("the page", page, "a page of viser", bare, first_picture),
    ]


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as name:
        print(json.dumps([figure.as_row() for figure in figures(name)]))
