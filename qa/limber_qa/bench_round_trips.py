"""What waiting costs, by what carries messages and frames: JOINT_STATE to JOINT_TORQUE through the
real controller, and a cycle of the three processes in lock step, each beside a bare UDP round trip.
"""

import json
import os
from pathlib import Path
from typing import Any

from limber.paths import RELEASE, ROOT
from limber_qa.bench_command import released, run
from limber_qa.bench_figure import Figure

SHARED = f"shm:bench-{os.getpid()}"
# Name, LIMBER_ARM_URL (empty: the default), LIMBER_VIRTUAL_BUS, goals of the two figures.
CARRIERS = [
    ("datagrams", "", "udp", 1.2, 2.2),
    ("shared memory", SHARED, "shm", None, 2.2),
    ("shared memory, polled", f"{SHARED}?poll", "shm?poll", 0.15, 0.5),
]
PORT = "43217"  # of the bench's own virtual buses
PEER = "UDP unicast round trip"


def figures(prefix: list[str]) -> list[Figure]:
    """`prefix`: a command that runs another in a private network, or nothing."""
    try:
        return [figure for carrier in CARRIERS for figure in _over(prefix, *carrier)]
    finally:
        for pattern in (f"limber-arm-{SHARED.removeprefix('shm:')}", f"limber-bus-*-{PORT}*"):
            for left in Path("/dev/shm").glob(pattern):
                left.unlink()


def _over(
    prefix: list[str], carrier: str, url: str, bus: str, goal: float | None, loop_goal: float | None
) -> list[Figure]:
    chosen = {"LIMBER_ARM_URL": url, "LIMBER_VIRTUAL_BUS": bus, "LIMBER_VIRTUAL_BUS_PORT": PORT}
    program = [released("limber-bench-loop"), "--controller", released("limber-controller")]
    state = _measure([*prefix, *program], chosen)
    scenario = str(ROOT / "qa" / "bench" / "whole_loop.yaml")
    loop = [released("limber-bench-whole-loop"), "--bin", str(RELEASE), "--scenario", scenario]
    cycle = _measure([*prefix, *loop], chosen)
    return [
        Figure(
            f"round trip through limber-controller, {carrier}",
            1000.0 * state["limber_us"]["p50"],
            PEER,
            1000.0 * state["udp_us"]["p50"],
            goal,
        ),
        Figure(
            f"cycle of three processes in lock step, {carrier}",
            1000.0 * cycle["cycle_us"],
            PEER,
            1000.0 * cycle["udp_us"],
            loop_goal,
        ),
    ]


def _measure(command: list[str], chosen: dict[str, str]) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(run(command, None, env={**os.environ, **chosen}))
    return found
