"""What messages and waiting cost, by arm plane: JOINT_STATE to JOINT_TORQUE through the real
controller, and a cycle of the three processes in lock step, each beside a bare UDP round trip."""

import json
import os
from pathlib import Path

from limber.dev.bench_command import released, run
from limber.dev.bench_figure import Figure
from limber.paths import RELEASE, ROOT

SHARED = f"shm:bench-{os.getpid()}"
# Arm plane, LIMBER_ARM_URL (empty: the default), goals of the two figures.
ARM_PLANES = [
    ("LCM's format", "", 1.2, 2.2),
    ("shared memory", SHARED, None, None),
    ("shared memory, polled", f"{SHARED}?poll", 0.15, 0.5),
]
PEER = "UDP unicast round trip"


def figures(prefix: list[str]) -> list[Figure]:
    """`prefix`: a command that runs another in a private network, or nothing."""
    try:
        return [figure for plane in ARM_PLANES for figure in _of_plane(prefix, *plane)]
    finally:
        for left in Path("/dev/shm").glob(f"limber-arm-{SHARED.removeprefix('shm:')}"):
            left.unlink()


def _of_plane(
    prefix: list[str], plane: str, url: str, goal: float | None, loop_goal: float | None
) -> list[Figure]:
    program = [released("limber-bench-loop"), "--controller", released("limber-controller")]
    state = _measure([*prefix, *program], url)
    scenario = str(ROOT / "bench" / "whole_loop.yaml")
    loop = [released("limber-bench-whole-loop"), "--bin", str(RELEASE), "--scenario", scenario]
    cycle = _measure([*prefix, *loop], url)
    return [
        Figure(
            f"round trip through limber-controller, {plane}",
            1000.0 * state["limber_us"]["p50"],
            PEER,
            1000.0 * state["udp_us"]["p50"],
            goal,
        ),
        Figure(
            f"cycle of three processes in lock step, {plane}",
            1000.0 * cycle["cycle_us"],
            PEER,
            1000.0 * cycle["udp_us"],
            loop_goal,
        ),
    ]


def _measure(command: list[str], url: str) -> dict:
    return json.loads(run(command, None, env={**os.environ, "LIMBER_ARM_URL": url}))
