"""Cost of a message in Python, beside lcm-gen's decode() of the same bytes.

    python -m limber_qa.bench_receiver LOG      # prints figures as JSON

The messages of a log, those of fixed size that come at a rate. Live: what `Receiver` does with each
and the reading of batches. From the log: opening it, and all these channels. The readers take
turns; processor time, the least of all turns.
"""

import json
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

from limber import messages
from limber.live.receiver import ChannelState, Stream
from limber.log.reader import Log
from limber_qa.bench_figure import Figure

CHANNELS = ("JOINT_STATE", "JOINT_TORQUE", "CONTROLLER_STATUS", "SIM_TRUTH")
BATCH = 16  # messages of a channel: what comes at 1 kHz between two looks of a Receiver
TURNS = 5
Messages = dict[str, list[bytes]]  # by channel


def live(found: Messages) -> int:
    """Messages read; the same below."""
    table, count = messages.channels(), 0
    for name, parts in found.items():
        state = ChannelState(table[name].type_name, table[name].numbered)
        stream = Stream(state, threading.Condition())
        for start in range(0, len(parts), BATCH):
            for data in parts[start : start + BATCH]:
                state.take(data)
            count += len(stream.read())
    return count


def from_log(path: Path) -> int:
    log = Log(path)
    return sum(len(log.read(name)) for name in CHANNELS)


def decoded(found: Messages) -> int:
    for name, parts in found.items():
        decode = messages.message_class(messages.channels()[name].type_name).decode
        for data in parts:
            decode(data)
    return sum(map(len, found.values()))


def least_ns(turns: dict[str, Callable[[], int]]) -> dict[str, float]:
    """Of each reader, for a message."""
    least = dict.fromkeys(turns, float("inf"))
    for _ in range(TURNS):
        for name, read in turns.items():
            begun = time.process_time_ns()
            count = read()
            least[name] = min(least[name], (time.process_time_ns() - begun) / count)
    return least


def figures(ns: dict[str, float]) -> list[Figure]:
    names = {"live": "a message read in Python, live", "log": "the same, from a log"}
    return [
        Figure(name, ns[key], "lcm-gen's decode()", ns["decode"], 0.1)
        for key, name in names.items()
    ]


def main(path: Path) -> None:
    log = Log(path)
    found = {name: log.raw(name) for name in CHANNELS}
    turns = {
        "live": lambda: live(found),
        "log": lambda: from_log(path),
        "decode": lambda: decoded(found),
    }
    print(json.dumps([figure.as_row() for figure in figures(least_ns(turns))]))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
