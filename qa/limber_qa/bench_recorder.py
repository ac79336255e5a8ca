"""`limber log record` beside lcm-logger: the highest rate without a loss, and long under load.

    python -m limber_qa.bench_recorder [SECONDS]      # prints figures as JSON

Messages of 304 bytes come from another process. At each rate both programs record in turn, twice;
a rate counts if nothing was lost once. lcm-logger leaves out the last messages before it is
stopped: those are forgiven.
"""

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import lcm

from limber_qa import bench_command
from limber_qa.bench_figure import Figure

RATES_Hz = (2_000, 5_000, 10_000, 20_000, 50_000, 100_000, 200_000)
SECONDS = 2.0
TRIES = 2
LOADED_Hz = 20_000
LOADED_s = 10.0  # by default
SUBSCRIBED_s = 0.7
OWN, PEER = "limber-record", "lcm-logger"
COMMANDS = {
    OWN: (bench_command.released(OWN), "--out"),
    PEER: (str(Path(lcm.__file__).parents[1] / "bin" / PEER), "-q"),  # in LCM's wheel
}


def figures(loaded_s: float) -> list[Figure]:
    own, peers = 0.0, 0.0
    for rate in RATES_Hz:
        own = max(own, _rate_without_loss(OWN, rate))
        peers = max(peers, _rate_without_loss(PEER, rate))
    lost = _lost(OWN, LOADED_Hz, loaded_s, loaded=True)[0]
    return [
        interval_figure(own, peers),
        Figure(
            f"messages lost by `limber log record`, {LOADED_Hz:,} a second for {loaded_s:g} s, "
            "stopped at once, all cores busy",
            lost,
            goal=0.0,
            unit="messages",
        ),
    ]


def interval_figure(own_Hz: float, peers_Hz: float) -> Figure:
    """From the highest rates without a loss; ten times lcm-logger's is a tenth of its interval."""
    own_ns, peers_ns = (1e9 / max(rate, 1.0) for rate in (own_Hz, peers_Hz))
    name = "`limber log record`: messages without a loss, one every"
    return Figure(name, own_ns, PEER, peers_ns, 0.1)


def _rate_without_loss(recorder: str, rate: int) -> float:
    """The rate at which the messages did come; 0 if some were lost each time."""
    for _ in range(TRIES):
        lost, came_Hz = _lost(recorder, rate, SECONDS)
        if lost == 0:
            return came_Hz
    return 0.0


def _lost(recorder: str, rate: int, seconds: float, loaded: bool = False) -> tuple[int, float]:
    """Messages lost, and the rate at which they were sent."""
    with tempfile.TemporaryDirectory() as folder, _busy(loaded):
        log = Path(folder) / "bench.lcmlog"
        process = subprocess.Popen(
            [*COMMANDS[recorder], str(log)],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        time.sleep(SUBSCRIBED_s)
        options = ("--rate", str(rate), "--seconds", str(seconds))
        sent = bench_command.report([], "limber-bench-publisher", *options)
        if recorder == PEER:
            time.sleep(1.0)
        process.send_signal(signal.SIGTERM)
        process.wait(timeout=60)
        numbers = _numbers(log)
    expected = numbers[-1] + 1 if numbers and recorder == PEER else sent["sent"]
    return expected - len(numbers), sent["sent"] / sent["seconds"]


def _numbers(log: Path) -> list[int]:
    """The numbers of the messages in a log."""
    return [int.from_bytes(event.data[8:16], "big") for event in lcm.EventLog(str(log), "r")]


@contextmanager
def _busy(loaded: bool) -> Iterator[None]:
    """Twice as many processes as cores that compute for ever."""
    count = 2 * len(os.sched_getaffinity(0)) if loaded else 0
    busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(count)]
    try:
        yield
    finally:
        for process in busy:
            process.kill()
            process.wait()


def main(loaded_s: float) -> None:
    print(json.dumps([figure.as_row() for figure in figures(loaded_s)]))


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else LOADED_s)
