"""`limber ros2`: out what arrives, in what is allowed."""

import signal
import threading
import time
from collections.abc import Callable
from contextlib import ExitStack, closing, suppress
from pathlib import Path
from typing import Any

from cyclonedds.core import InstanceState, ReadCondition, SampleState, ViewState, WaitSet
from cyclonedds.internal import InvalidSample
from cyclonedds.util import duration
from rich.console import Console

from limber.live.arm import Arm
from limber.live.arm_errors import StackLostError
from limber.live.arm_state import State
from limber.live.stamps import Stamps
from limber.model.robot import Robot, load_robot
from limber.ros2 import diagnostics, to_ros
from limber.ros2 import ros_types as ros
from limber.ros2.domain import Participant, domain_id
from limber.ros2.from_ros import Requests

DIAGNOSTICS_S = 1.0
CHANGED_S = 0.1  # diagnostics that have changed come sooner
LOST_S = 0.2
GOAL, STIFFNESS = "/limber/goal_pose", "/limber/stiffness"


def run(
    named: str | None, rate_hz: float, interface: str, allow_commands: bool, console: Console
) -> None:
    """Until Ctrl-C or SIGTERM, which are its good end."""
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    domain = domain_id()
    participant = Participant(domain, interface)
    wanted = None if named is None else load_robot(named)
    requests = None
    with suppress(KeyboardInterrupt), ExitStack() as ends:
        arm = ends.enter_context(Arm(None if wanted is None else wanted.name))
        robot = wanted or load_robot(arm.folder if Path(arm.folder).is_dir() else arm.name)
        told = f"{robot.name} in ROS's domain {domain} on {interface}"
        if allow_commands:
            requests = Requests(arm, robot.base, lambda line: console.print(line, markup=False))
            ends.enter_context(closing(Inlet(participant, requests)))
            told += f"; takes {GOAL} in {robot.base}, {STIFFNESS}"
        console.print(f"{told}. Ctrl-C ends it.", soft_wrap=True, markup=False)
        Outlet(participant, arm, robot, requests).loop(1.0 / rate_hz)


class Outlet:
    """What goes out: each message once, the newest, none if it has not arrived."""

    def __init__(
        self, participant: Participant, arm: Arm, robot: Robot, requests: Requests | None
    ) -> None:
        self._arm, self._robot, self._requests = arm, robot, requests
        self._joints = participant.writer("/joint_states", ros.JointState)
        self._pose = participant.writer("/limber/tip_pose", ros.PoseStamped)
        self._wrench = participant.writer("/limber/contact_wrench", ros.WrenchStamped)
        self._diagnostics = participant.writer("/diagnostics", ros.DiagnosticArray)
        self._description = participant.writer("/robot_description", ros.String, latched=True)
        self._description.write(ros.String(robot.urdf.read_text(encoding="utf-8")))
        self._stamps = Stamps()
        self._sent: dict[str, tuple[int, int]] = {}
        self._looked_s = self._told_s = float("-inf")
        self._told: object = None

    def loop(self, period_s: float) -> None:
        due_s = time.monotonic()
        while True:
            try:
                self._send(self._arm.state, time.time_ns())
                due_s += period_s
            except StackLostError as lost:
                self._diagnose([diagnostics.lost_status(str(lost), self._robot.name)], "lost")
                due_s += max(LOST_S, period_s)
            due_s = max(due_s, time.monotonic())
            time.sleep(max(0.0, due_s - time.monotonic()))

    def _send(self, state: State, now_ns: int) -> None:
        record, status, robot = state.joint_state, state.status, self._robot
        if self._is_new("joints", record["session"], record["seq"]):
            self._stamps.note(int(record["session"]), int(record["time_ns"]), now_ns)
            stamp_ns = self._stamps.of(int(record["time_ns"]), now_ns)
            self._joints.write(to_ros.joint_state(state, self._arm.joint_names, stamp_ns))
        if self._is_new("status", status["controller"], status["seq"]):
            stamp_ns = self._stamps.of(int(status["time_ns"]), now_ns)
            self._pose.write(to_ros.tip_pose(state.pose, robot.base, stamp_ns))
            if status["contact"]:
                self._wrench.write(to_ros.contact_wrench(state, robot.tip, stamp_ns))
        if time.monotonic() - self._looked_s >= CHANGED_S:
            self._look(state)

    def _is_new(self, what: str, sender: int, seq: int) -> bool:
        before, self._sent[what] = self._sent.get(what), (int(sender), int(seq))
        return before != self._sent[what]

    def _look(self, state: State) -> None:
        """Diagnostics: each second, sooner if a level, the mode or a refusal has changed."""
        outcomes = None if self._requests is None else self._requests.outcomes
        name, joints = self._robot.name, self._arm.joint_names
        arm = diagnostics.arm_status(state, name)
        commands = diagnostics.command_status(outcomes, name)
        found = [arm, *diagnostics.joint_statuses(state, joints, name), commands]
        self._diagnose(found, ([each.level for each in found], arm.message, commands.message))

    def _diagnose(self, found: list[ros.DiagnosticStatus], changes: object) -> None:
        self._looked_s = time.monotonic()
        if changes != self._told or self._looked_s - self._told_s >= DIAGNOSTICS_S:
            self._told, self._told_s = changes, self._looked_s
            header = to_ros.header(time.time_ns())
            self._diagnostics.write(ros.DiagnosticArray(header, found))


class Inlet:
    """Commands, in a thread of their own until close()."""

    def __init__(self, participant: Participant, requests: Requests) -> None:
        self._requests = requests
        self._takers: list[tuple[Any, Callable]] = [
            (participant.reader(GOAL, ros.PoseStamped), requests.goal),
            (participant.reader(STIFFNESS, ros.Float64MultiArray), requests.stiffness),
        ]
        self._news = WaitSet(participant.entity)
        every = ViewState.Any | InstanceState.Any | SampleState.Any
        self._conditions = [ReadCondition(reader, every) for reader, _ in self._takers]
        for condition in self._conditions:
            self._news.attach(condition)
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._take, name="limber ros2", daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._stop.set()
        self._thread.join()

    def _take(self) -> None:
        while not self._stop.is_set():
            self._news.wait(duration(milliseconds=100))
            for reader, request in self._takers:
                try:
                    samples = reader.take()
                except Exception as error:  # whatever its decoder meets
                    self._requests.unreadable(reader.topic.name.removeprefix("rt"), error)
                    continue
                for sample in samples:
                    if not isinstance(sample, InvalidSample):  # a writer has left
                        request(sample)
