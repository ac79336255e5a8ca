"""What messages and waiting cost, by arm plane: JOINT_STATE to JOINT_TORQUE through the real
controller, and a cycle of the three processes in lock step, each beside a bare UDP round trip."""

import json
import os
import subprocess
from pathlib import Path

from limber.errors import RunError
from limber.paths import RELEASE, ROOT

SHARED = f"shm:bench-{os.getpid()}"
# Arm plane, LIMBER_ARM_URL (empty: the default), goals of the two figures.
ARM_PLANES = [
    ("LCM's format", "", 1.2, 2.2),
    ("shared memory", SHARED, None, None),
    ("shared memory, polled", f"{SHARED}?poll", 0.15, 0.5),
]
PEER = "UDP unicast round trip"
Row = tuple[str, float, str, float, float | None]  # name, ns, peer, its ns, goal


def rows(prefix: list[str]) -> list[Row]:
    """`prefix`: a command that runs another in a private network, or nothing."""
    try:
        return [row for plane in ARM_PLANES for row in _of_plane(prefix, *plane)]
    finally:
        for left in Path("/dev/shm").glob(f"limber-arm-{SHARED.removeprefix('shm:')}"):
            left.unlink()


def _of_plane(
    prefix: list[str], plane: str, url: str, goal: float | None, loop_goal: float | None
) -> list[Row]:
    state = _measure(
        [*prefix, RELEASE / "limber-bench-loop", "--controller", RELEASE / "limber-controller"], url
    )
    scenario = ROOT / "bench" / "whole_loop.yaml"
    loop = [RELEASE / "limber-bench-whole-loop", "--bin", RELEASE, "--scenario", scenario]
    cycle = _measure([*prefix, *loop], url)
    return [
        (
            f"round trip through limber-controller, {plane}",
            1000.0 * state["limber_us"]["p50"],
            PEER,
            1000.0 * state["udp_us"]["p50"],
            goal,
        ),
        (
            f"cycle of three processes in lock step, {plane}",
            1000.0 * cycle["cycle_us"],
            PEER,
            1000.0 * cycle["udp_us"],
            loop_goal,
        ),
    ]


def _measure(command: list, url: str) -> dict:
    words = [str(word) for word in command]
    environment = {**os.environ, "LIMBER_ARM_URL": url}
    done = subprocess.run(
        words, cwd=ROOT, env=environment, check=False, capture_output=True, text=True
    )
    if done.returncode != 0:
        raise RunError(f"{' '.join(words)} failed (exit code {done.returncode}):\n{done.stderr}")
    return json.loads(done.stdout)
