"""`limber monitor --foxglove`: the running arm in the Foxglove app, read only.

The topics are those of `limber log convert --to mcap`, so that one layout fits both; /joint_states
beside them moves a URDF in the 3D panel. Every message of the user plane goes out
that a viewer has subscribed to; poses and joint states once a turn.
"""

import time
from collections.abc import Iterator
from contextlib import closing, suppress
from typing import Any

import foxglove
import numpy as np
from rich.console import Console

from limber import messages
from limber.errors import RunError
from limber.live.stamps import Stamps
from limber.log.convert.foxglove_messages import POSES, Message, Messages, time_of, topic_of
from limber.log.convert.windows import Batch, identifiers
from limber.model.robot import Robot
from limber.monitor.feed import Batch as FeedBatch
from limber.monitor.live_feed import LiveFeed
from limber.monitor.running_arm import RunningArm, follow_arms
from limber.monitor.server import HOST

PORT = 8765  # what the app proposes
TURN_S = 0.02
BACKLOG = 1 << 14  # messages kept for a slow viewer: seconds
JOINT_STATES = "/joint_states"


def live(named: str | None, port: int, console: Console) -> None:
    """Until Ctrl-C or SIGTERM. `named`: the arm, else the one that runs, and the next one."""

    def show(robot: Robot, feed: LiveFeed, running: RunningArm) -> bool:
        with closing(Outlet(robot, port)) as outlet, suppress(KeyboardInterrupt):
            console.print(
                f"{robot.name}: Foxglove, Open connection, ws://{HOST}:{port}  [dim]read only; the "
                f"arm's shape: add {robot.urdf} as URDF to the 3D panel; Ctrl-C ends it[/]",
                soft_wrap=True,
            )
            while named is not None or not running.other_than(robot):
                running.note(outlet.send(feed))
                time.sleep(TURN_S)
            return True
        return False

    follow_arms(named, console, show)


class Outlet:
    """The server; close() ends it. Raises RunError if the port is taken."""

    def __init__(self, robot: Robot, port: int) -> None:
        self._context = foxglove.Context()
        try:
            self._server = foxglove.start_server(
                name=f"limber: {robot.name}",
                host=HOST,
                port=port,
                context=self._context,
                message_backlog_size=BACKLOG,
            )
        except (OSError, RuntimeError) as error:
            raise RunError(f"port {port} of {HOST}: {error}; give another --port") from error
        self._joints = robot.joint_names
        self._messages = Messages(identifiers(robot.joint_names))
        self._channels: dict[str, foxglove.Channel] = {}  # by topic
        self._stamps = Stamps()

    def close(self) -> None:
        for channel in self._channels.values():
            channel.close()
        self._server.stop()

    def send(self, feed: LiveFeed) -> FeedBatch:
        """What has come since the last call, which is returned, too."""
        taken, now_ns = feed.take(), time.time_ns()
        state = taken.arrays.get("JOINT_STATE")
        if state is not None:
            self._stamps.note(int(state[-1]["session"]), int(state[-1]["time_ns"]), now_ns)
        rows: dict[str, np.ndarray | list[Any]] = {**taken.arrays, **taken.objects}
        for channel, found in rows.items():
            for message in self._encoded(channel, found, now_ns):
                self._log(message)
        return taken

    def _encoded(
        self, channel: str, rows: np.ndarray | list[Any], now_ns: int
    ) -> Iterator[Message]:
        stamps = [self._stamps.of(t, now_ns) // 1000 for t in _arm_times_ns(rows)]
        type_name = messages.channels()[channel].type_name
        batch = Batch(channel, type_name, np.array(stamps, np.int64), rows)
        if self._wanted(topic_of(channel)):
            yield from self._messages.encode(batch)
        if channel == "CONTROLLER_STATUS" and any(map(self._wanted, POSES)):
            last = Batch(channel, type_name, batch.stamps_us[-1:], rows[-1:])
            for stream in self._messages.poses(last):
                yield from stream
        if channel == "JOINT_STATE" and self._wanted(JOINT_STATES):
            yield self._joint_states(stamps[-1], rows[-1])

    def _wanted(self, topic: str) -> bool:
        """A viewer has subscribed to it, or has still to be told that it is there."""
        channel = self._channels.get(topic)
        return channel is None or channel.has_sinks()

    def _joint_states(self, stamp_us: int, state: np.void) -> Message:
        values = zip(self._joints, *(state[k].tolist() for k in ("q", "v", "tau")), strict=False)
        joints = [
            {"name": name, "position": q, "velocity": v, "effort": tau}
            for name, q, v, tau in values
        ]
        content = {"timestamp": time_of(stamp_us), "joints": joints}
        return self._messages.json(JOINT_STATES, "foxglove.JointStates", content, stamp_us)

    def _log(self, message: Message) -> None:
        stamp_us, topic, data = message
        if topic.name not in self._channels:
            schema = foxglove.Schema(
                name=topic.schema, encoding=topic.schema_encoding, data=topic.described
            )
            self._channels[topic.name] = foxglove.Channel(
                topic.name, schema=schema, message_encoding=topic.encoding, context=self._context
            )
        self._channels[topic.name].log(data, log_time=stamp_us * 1000)


def _arm_times_ns(rows: np.ndarray | list[Any]) -> list[int]:
    if isinstance(rows, np.ndarray):
        times_ns: list[int] = rows["time_ns"].tolist()
        return times_ns
    return [int(row.time_ns) for row in rows]
