"""Cost of a message in Python: read in batches by numpy, beside lcm-gen's class for each.

    python -m limber.dev.bench_receiver      # prints figures as JSON

Five channels at 2 kHz each, 10,000 messages a second, from another process; all of
them are read, fifty times a second. Processor time of the reading process, not wall time.
"""

import json
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import closing

import lcm

from limber import messages
from limber.dev.bench_figure import Figure
from limber.live.receiver import Receiver

# Those of fixed size that come at a rate.
CHANNELS = ("JOINT_STATE", "JOINT_TORQUE", "CONTROLLER_STATUS", "DRIVER_STATUS", "SIM_TRUTH")
RATE_HZ = 2000  # of each channel
SECONDS = 4.0
READ_S = 0.02


def publish() -> None:
    """For ever: numbered messages of each channel, a burst each millisecond."""
    line = lcm.LCM(messages.user_plane_url())
    types = {name: messages.channels()[name].type_name for name in CHANNELS}
    blank = {name: bytearray(messages.message_class(t)().encode()) for name, t in types.items()}
    seq, due = 0, time.monotonic()
    while True:
        for _ in range(RATE_HZ // 1000):
            seq += 1
            for name, data in blank.items():
                data[8:16] = seq.to_bytes(8, "big")
                line.publish(name, bytes(data))
        due += 1e-3
        time.sleep(max(0.0, due - time.monotonic()))


def batches() -> tuple[int, int]:
    """Messages read and lost."""
    read = 0
    with closing(Receiver(*CHANNELS)) as receiver:
        streams = {name: receiver.stream(name) for name in CHANNELS}
        end = time.monotonic() + SECONDS
        while time.monotonic() < end:
            time.sleep(READ_S)
            read += sum(len(stream.read()) for stream in streams.values())
        return read, sum(state.lost for state in receiver.channels.values())


def classes(decoded: bool) -> tuple[int, int]:
    """The same with a subscription and lcm-gen's decode() in each callback."""
    line = lcm.LCM(messages.user_plane_url())
    seen = dict.fromkeys(CHANNELS, 0)
    types = {n: messages.message_class(messages.channels()[n].type_name) for n in CHANNELS}

    def take(channel: str, data: bytes) -> None:
        if decoded:
            types[channel].decode(data)
        seen[channel] += 1

    subscriptions = [line.subscribe(name, take) for name in CHANNELS]
    for subscription in subscriptions:
        subscription.set_queue_capacity(0)
    end = time.monotonic() + SECONDS
    while time.monotonic() < end:
        line.handle_timeout(100)
    for subscription in subscriptions:
        line.unsubscribe(subscription)
    return sum(seen.values()), 0


def _cost_us(read: Callable[[], tuple[int, int]]) -> tuple[float, int, int]:
    """Processor time a message, messages, messages lost."""
    before = time.process_time()
    count, lost = read()
    return 1e6 * (time.process_time() - before) / max(count, 1), count, lost


def main() -> None:
    publisher = subprocess.Popen([sys.executable, "-m", "limber.dev.bench_receiver", "publish"])
    try:
        time.sleep(1.0)
        bare, _, _ = _cost_us(lambda: classes(decoded=False))
        own, count, lost = _cost_us(batches)
        peer, _, _ = _cost_us(lambda: classes(decoded=True))
    finally:
        publisher.terminate()
        publisher.wait()
    print(json.dumps([figure(own, peer, bare).as_row(), lost_figure(count, lost).as_row()]))


def figure(own_us: float, peer_us: float, bare_us: float) -> Figure:
    """`bare_us`: LCM's part, which both have."""
    own_ns, peer_ns = (1000.0 * max(cost - bare_us, 0.0) for cost in (own_us, peer_us))
    return Figure("reading a message in Python, live", own_ns, "lcm-gen's decode()", peer_ns, 0.1)


def lost_figure(count: int, lost: int) -> Figure:
    return Figure(f"of {count} messages read so, lost", lost, goal=0.0, unit="messages")


if __name__ == "__main__":
    publish() if sys.argv[1:] == ["publish"] else main()
