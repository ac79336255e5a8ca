"""The arm's readings, from a driver alone: no controller is started, so no drive can be enabled."""

import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console

from limber import messages, problems
from limber.errors import InputError, RunError
from limber.live import network
from limber.live.receiver import Receiver, driver_is_running
from limber.model.robot import Robot
from limber.paths import program, run_folder
from limber.problems import sentence
from limber.run import buses
from limber.run.commands import next_folder
from limber.run.processes import ProcessGroup, process_group, sigterm_as_interrupt

START_S = 10.0
SILENT_S = 5.0  # of a tool that itself waits for a busy machine
SIMULATED_HZ = 50.0
CHANNELS = ("JOINT_STATE", "CONTROLLER_STATUS", "ROBOT_INFO")


@dataclass(frozen=True)
class DriverOptions:
    buses: tuple[str, ...] = ()  # NAME=ADDR, each overrides an address of robot.yaml
    with_simulator: bool = True  # where all buses are virtual
    private_network: bool = False


@dataclass(frozen=True)
class Readings:
    time_s: float
    theta: np.ndarray  # of the motors
    apart: np.ndarray  # of the links' encoders, more than theta; 0 where there is none
    fresh: np.ndarray


class Drives:
    """What the driver tells. Every read looks at all messages: RunError once a drive is not off."""

    def __init__(self, robot: Robot, receiver: Receiver, group: ProcessGroup | None) -> None:
        self._robot, self._receiver, self._group = robot, receiver, group
        self._stream = receiver.stream("JOINT_STATE")
        self._since_s = time.monotonic()
        self._off = False  # they have been seen off
        self.awaited = "the driver looks for the drives"  # until there are readings
        self.simulated = False

    def read(self) -> Readings | None:
        """The newest readings; None if there are none yet, or no new ones."""
        if self._group is not None:
            self._group.check()
        states = self._stream.read()
        if not len(states):
            self._require_sound()
            return None
        self._since_s = time.monotonic()
        for state in states:
            self._require_off(state)
        return self._readings(states) if self._off else None

    def news(self) -> list[str]:
        """What the driver has logged since, such as a motor that does not answer."""
        if self._group is None:
            return []
        return self._group.children["limber-driver"].news()

    def controller_heard(self) -> bool:
        """A controller runs as well: somebody could have it enable the drives."""
        return self._receiver.channels["CONTROLLER_STATUS"].count > 0

    def _require_sound(self) -> None:
        silent_s = time.monotonic() - self._since_s
        if (self._off or self._group is None) and silent_s > SILENT_S:
            raise RunError(f"the driver has been silent for {silent_s:.0f} s: see its log")

    def _require_off(self, state: np.void) -> None:
        kinds = messages.message_class("joint_state_t")
        number = int(state["drive_state"])
        if int(state["num_joints"]) != len(self._robot.joints):
            raise RunError(
                f"the running driver has an arm of {int(state['num_joints'])} joints, "
                f"{self._robot.name} has {len(self._robot.joints)}: stop it first"
            )
        enabled = np.flatnonzero(state["joint_flags"] & kinds.JOINT_ENABLED)
        if number == kinds.DRIVE_OFF and not len(enabled):
            self._off = True
        elif self._off or number != kinds.DRIVE_CONFIGURING:
            raise RunError(self._not_off(state, number, enabled))
        else:
            self.awaited = "the driver reads and writes the drives' settings"

    def _not_off(self, state: np.void, number: int, enabled: np.ndarray) -> str:
        name = messages.constants("joint_state_t", "DRIVE_").get(number, str(number))
        when = "the drives have become" if self._off else "the drives are"
        text = f"{when} {name}, not OFF: take your hands off the arm"
        if name == "OFF":
            text = f"the drive of {self._robot.joints[enabled[0]].name} is enabled: hands off"
        fault = problems.problem("driver", state["fault"])
        if fault is not None and int(state["fault"]):
            return f"{text}. {fault.code}: {sentence(fault.what)} To do: {fault.remedy}."
        return f"{text}. Nobody turns a powered arm; `limber send 'mode: idle'` switches drives off"

    def _readings(self, states: np.ndarray) -> Readings:
        """Of each joint the newest that is fresh: a reply that is lost now and then is no loss."""
        bit = messages.message_class("joint_state_t").JOINT_FRESH
        count = len(self._robot.joints)
        fresh = (states["joint_flags"][:, :count] & bit) != 0
        newest = len(states) - 1 - np.argmax(fresh[::-1], axis=0)
        theta = states["theta"][newest, np.arange(count)]
        apart = states["q"][newest, np.arange(count)] - theta
        return Readings(float(states["time_ns"][-1]) * 1e-9, theta, apart, fresh.any(axis=0))


@contextmanager
def drives(robot: Robot, options: DriverOptions, console: Console) -> Iterator[Drives]:
    """A driver that runs already is used; else one is started, and with virtual buses an arm."""
    addresses = buses.addresses(robot, options.buses)
    if buses.real(addresses):
        network.require_shared_network(options.private_network)
    else:
        network.ensure_multicast(options.private_network)
    if driver_is_running():
        with closing(Receiver(*CHANNELS)) as receiver:
            _require_this_arm(robot, receiver)
            console.print("A driver is running already: it is listened to.")
            yield Drives(robot, receiver, None)
        return
    with_simulator = options.with_simulator and not buses.real(addresses)
    folder = run_folder(next_folder(f"joints-{robot.name}"))
    with (
        closing(Receiver(*CHANNELS)) as receiver,
        process_group(folder) as group,
        sigterm_as_interrupt(),
    ):
        _start(group, robot, options.buses, with_simulator)
        found = Drives(robot, receiver, group)
        found.simulated = with_simulator
        yield found


def _start(
    group: ProcessGroup, robot: Robot, overrides: tuple[str, ...], with_simulator: bool
) -> None:
    words = ["--robot", str(robot.folder), *(w for bus in overrides for w in ("--bus", bus))]
    if with_simulator:  # no controller, so no lock step: slow enough for a machine that is busy
        words += ["--rate", f"{min(robot.rate_hz, SIMULATED_HZ):.9g}"]
        command = [str(program("limber-sim")), *words, "--realtime", "--no-stand"]
        group.wait_for_line(group.start("limber-sim", command), "\n", START_S)
    group.start("limber-driver", [str(program("limber-driver")), *words])


def _require_this_arm(robot: Robot, receiver: Receiver, wait_s: float = 0.5) -> None:
    """A controller names the arm; of a driver alone only the number of joints is known."""
    info = receiver.channels["ROBOT_INFO"]
    if not receiver.wait_for(lambda: info.count > 0, wait_s):
        return
    named = messages.decode("robot_info_t", info.data)
    same = Path(named.folder) == robot.folder if named.folder else named.robot == robot.name
    if not same:
        raise InputError(
            f"the running arm is {named.robot} ({named.folder}), not {robot.folder}: name that "
            "one, or stop it first"
        )
