"""Figures of the real-time side: what cycles ask of heap and kernel, how late they start, what the
exchange with the drives costs. Each is a program of its own, run beside its peer.
"""

import shutil
import statistics
from bisect import bisect_left
from dataclasses import dataclass
from itertools import accumulate

from limber_qa import bench_command
from limber_qa.bench_figure import Figure

PRIORITY = 90
PERIOD_us = 1000
WINDOWS = 5
WINDOW_s = 2
LONGEST_us = 20_000  # of cyclictest's histogram


def calls(cycles: int) -> list[Figure]:
    """P3: of a driver, a controller and motor nodes in one process."""
    found = bench_command.report([], "limber-bench-calls", "--cycles", str(cycles))
    kinds = {
        "heap_requests": "heap requests",
        "page_faults": "page faults",
        "futex_calls": "futex calls",
    }
    count = f"{found['cycles']:,} cycles of driver, controller and motor nodes"
    return [
        Figure(f"{words} in {count}", found[key], goal=0.0, unit=words.split()[1])
        for key, words in kinds.items()
    ]


@dataclass(frozen=True)
class Window:
    """How late cycles of one window started."""

    p99_ns: float
    overruns: int


def lateness() -> list[Figure]:
    """P6: the driver's loop and the peer take turns; median over the windows, sum of overruns."""
    peer = "cyclictest -p 90" if shutil.which("cyclictest") else "clock_nanosleep alone"
    own, peers = [], []
    for _ in range(WINDOWS):
        own.append(_own_window())
        peers.append(_cyclictest() if "cyclictest" in peer else _own_window("--plain"))
    return lateness_figures(own, peers, peer)


def lateness_figures(own: list[Window], peers: list[Window], peer: str) -> list[Figure]:
    late = [statistics.median(w.p99_ns for w in windows) for windows in (own, peers)]
    over = [sum(w.overruns for w in windows) for windows in (own, peers)]
    return [
        Figure("start of a cycle at 1 kHz, late by (99 %)", late[0], peer, late[1], 0.05),
        Figure("cycles that start late by a period", over[0], peer, over[1], 1.0, "cycles"),
    ]


def _own_window(*options: str) -> Window:
    seconds = ("--seconds", str(WINDOW_s))
    found = bench_command.report([], "limber-bench-lateness", *seconds, *options)
    return Window(found["p99_ns"], found["overruns"])


def _cyclictest() -> Window:
    cycles = WINDOW_s * 1_000_000 // PERIOD_us
    options = f"-m -q -t 1 -p {PRIORITY} -i {PERIOD_us} -l {cycles} -h {LONGEST_us}"
    return window_of(bench_command.run(["cyclictest", *options.split()], None))


def window_of(histogram: str) -> Window:
    """Of what cyclictest prints: lines `microseconds cycles`, and the number of those beyond."""
    bins: list[tuple[int, int]] = []
    beyond = 0
    for line in histogram.splitlines():
        if line.startswith("# Histogram Overflows:"):
            beyond = int(line.split(":")[1].split()[0])
        elif line[:1].isdigit():
            late_us, cycles = line.split()[:2]
            bins.append((int(late_us), int(cycles)))
    bins.append((LONGEST_us, beyond))
    totals = list(accumulate(cycles for _, cycles in bins))
    p99_us = bins[bisect_left(totals, 0.99 * totals[-1])][0]
    return Window(1000.0 * p99_us, sum(cycles for late, cycles in bins if late >= PERIOD_us))


def exchange(prefix: list[str]) -> Figure:
    """P12: commands out, replies in, between two processes."""
    found = bench_command.report(prefix, "limber-bench-exchange")
    return Figure(
        "the driver's exchange with 7 drives, virtual bus",
        found["own_ns"]["p50"],
        "bare sendmmsg and recvmmsg",
        found["bare_ns"]["p50"],
        1.2,
    )
