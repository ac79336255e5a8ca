"""Starts the real processes and listens to what they say; see conftest.py for their network."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import threading
import time
from collections import defaultdict
from pathlib import Path

import numpy as np
import yaml

from limber import messages
from limber.lcmtypes.controller_status_t import controller_status_t
from limber.lcmtypes.driver_status_t import driver_status_t
from limber.lcmtypes.joint_command_t import joint_command_t
from limber.lcmtypes.joint_state_t import joint_state_t
from limber.lcmtypes.mode_request_t import mode_request_t
from limber.lcmtypes.sim_truth_t import sim_truth_t
from limber.live.line import Line

ROOT = Path(__file__).resolve().parents[2]
BIN = Path(os.environ.get("LIMBER_BIN", ROOT / "build" / "dev" / "bin"))
USER_URL = "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=2097152"
ARM_URL = "udpm://239.255.76.68:7668?ttl=0&recv_buf_size=2097152"
TYPES = {
    "JOINT_STATE": joint_state_t,
    "JOINT_TORQUE": joint_command_t,
    "CONTROLLER_STATUS": controller_status_t,
    "DRIVER_STATUS": driver_status_t,
    "SIM_TRUTH": sim_truth_t,
}
CLIENT = 77
GENEROUS = 4  # on a machine that is busy elsewhere


class Listener:
    """Keeps the newest message and all raw messages of each channel of a plane, and `also` of
    these, which are none of limber's.
    """

    def __init__(self, url: str, *also: str) -> None:
        self.lcm = Line(url)
        self.raw: dict[str, list[bytes]] = defaultdict(list)
        self._lock = threading.Lock()
        self._stop = False
        # The arm plane's two have the same names there.
        for channel in (*messages.channels(), *also):
            self.lcm.subscribe(channel, self._on_message)
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _on_message(self, channel: str, data: bytes) -> None:
        with self._lock:
            self.raw[channel].append(data)

    def _run(self) -> None:
        while not self._stop:
            self.lcm.handle_timeout(50)

    def close(self) -> None:
        self._stop = True
        self._thread.join()
        self.lcm.close()

    def count(self, channel: str) -> int:
        with self._lock:
            return len(self.raw[channel])

    def latest(self, channel: str):
        with self._lock:
            data = self.raw[channel][-1] if self.raw[channel] else None
        return None if data is None else TYPES[channel].decode(data)

    def since(self, channel: str, index: int) -> list:
        with self._lock:
            data = self.raw[channel][index:]
        return [TYPES[channel].decode(item) for item in data]


PACES = ("--paced", "--lockstep", "--realtime")
SLOW_HZ = 50


def slow_arm(folder: Path) -> str:
    """openarm for real time on a machine that is busy elsewhere: what a wire's two cycles bridge
    is 40 ms at its rate, its gains are as soft as that rate needs.
    """
    shutil.copytree(ROOT / "robots" / "openarm", folder)
    path = folder / "robot.yaml"
    robot = yaml.safe_load(path.read_text(encoding="utf-8"))
    robot["rate_hz"] = SLOW_HZ
    robot["watchdog"]["timeout_s"] = 0.3
    robot["gains"] |= {
        "K_q_Nm_per_rad": [20, 20, 13, 13, 1.3, 1.3, 1.3],
        "K_x_translation_N_per_m": 70,
        "K_x_rotation_Nm_per_rad": 1.2,
        "K_null_Nm_per_rad": [2, 2, 2, 2, 0.3, 0.3, 0.3],
        "D_null_Nms_per_rad": [0.5, 0.5, 0.5, 0.5, 0.03, 0.03, 0.03],
    }
    path.write_text(yaml.safe_dump(robot), encoding="utf-8")
    return str(folder)


class Stack:
    """The three processes of one arm on a virtual bus: in lock step at the clock's pace, so that
    simulated time waits for the machine, unless `pace` says otherwise.
    """

    def __init__(self, directory: Path, robot: str = "openarm", pace: str = PACES[0]) -> None:
        self.directory = directory
        self.robot = robot
        self.pace = pace
        self.under: list[str] = []  # a command that starts the processes
        self.processes: dict[str, subprocess.Popen] = {}
        self.starts: dict[str, int] = defaultdict(int)
        self.user = Listener(USER_URL)

    def start(self, name: str, *arguments: str, tag: str | None = None) -> subprocess.Popen:
        tag = tag or name
        self.starts[tag] += 1
        path = self.directory / f"{tag}-{self.starts[tag]}.log"
        pace = [] if set(arguments) & set(PACES) else [self.pace]
        program = str(BIN / f"limber-{name}")
        command = [*self.under, program, "--robot", self.robot, *pace, *arguments]
        with open(path, "w", encoding="utf-8") as log:
            process = subprocess.Popen(
                command, stdout=log, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL
            )
        self.processes[tag] = process
        return process

    def start_all(self, *sim_arguments: str) -> None:
        self.start("sim", *sim_arguments)
        self.start("controller")
        time.sleep(0.3)
        self.start("driver")

    def kill(self, tag: str) -> None:
        self.processes[tag].send_signal(signal.SIGKILL)
        self.processes[tag].wait()

    def request(self, what: int, client: int = CLIENT) -> None:
        message = mode_request_t()
        status = self.user.latest("CONTROLLER_STATUS")
        message.seq = time.monotonic_ns()
        message.controller = 0 if status is None else status.controller
        message.client = client
        message.request = what
        self.user.lcm.publish("MODE_REQUEST", message.encode())

    @property
    def mode(self) -> int | None:
        status = self.user.latest("CONTROLLER_STATUS")
        return None if status is None else status.mode

    @property
    def state(self) -> joint_state_t:
        return self.user.latest("JOINT_STATE")

    @property
    def truth(self) -> sim_truth_t:
        return self.user.latest("SIM_TRUTH")

    @property
    def positions(self) -> np.ndarray:
        """Of the links, as they truly are."""
        truth = self.truth
        return np.array(truth.q[: truth.num_joints])

    @property
    def driver_status(self) -> driver_status_t:
        return self.user.latest("DRIVER_STATUS")

    @property
    def time_s(self) -> float:
        """Arm time."""
        state = self.user.latest("JOINT_STATE")
        return 0.0 if state is None else 1e-9 * state.time_ns

    def pass_time(self, seconds: float) -> None:
        """Of the arm."""
        end_s = self.time_s + seconds
        self.until(lambda: self.time_s >= end_s, 10 + seconds, f"{seconds} s of arm time")

    def until(self, condition, seconds: float, what: str) -> None:
        """Waits for a condition; a generous bound, since tests never judge wall-clock speed."""
        end = time.monotonic() + GENEROUS * seconds
        while time.monotonic() < end:
            for tag, process in self.processes.items():
                if process.poll() not in (None, -signal.SIGKILL):
                    raise AssertionError(
                        f"{tag} ended by itself with {process.returncode}:\n{self.log(tag)}"
                    )
            if condition():
                return
            time.sleep(0.01)
        raise AssertionError(
            f"waited {GENEROUS * seconds} s in vain for: {what}\n" + self.describe()
        )

    def log(self, tag: str) -> str:
        text = (self.directory / f"{tag}-{self.starts[tag]}.log").read_text(encoding="utf-8")
        return text[-2000:]

    def describe(self) -> str:
        status = self.user.latest("CONTROLLER_STATUS")
        state = self.user.latest("JOINT_STATE")
        lines = []
        if status is not None:
            lines.append(f"controller: mode {status.mode} reason {status.reason}")
        if state is not None:
            lines.append(
                f"driver: state {state.drive_state} fault {state.fault} joint {state.fault_joint}"
            )
        return "\n".join(lines + [f"--- {tag}\n{self.log(tag)}" for tag in self.processes])

    def bring_to(self, mode: int) -> None:
        """Asks again and again, as an operator would, until the controller is in HOLD or ACTIVE."""
        ask = {
            controller_status_t.MODE_HOLD: mode_request_t.REQUEST_HOLD,
            controller_status_t.MODE_ACTIVE: mode_request_t.REQUEST_ACTIVE,
        }
        end = time.monotonic() + GENEROUS * 20
        while self.mode != mode and time.monotonic() < end:
            below_hold = self.mode is None or self.mode < controller_status_t.MODE_HOLD
            self.request(mode_request_t.REQUEST_HOLD if below_hold else ask[mode])
            time.sleep(0.1)
        assert self.mode == mode, f"mode {mode} not reached\n{self.describe()}"

    def acknowledge(self) -> None:
        """Until the fault is gone: an operator is refused as long as its cause is there."""
        end = time.monotonic() + GENEROUS * 20
        while self.mode != controller_status_t.MODE_IDLE and time.monotonic() < end:
            self.request(mode_request_t.REQUEST_ACKNOWLEDGE)
            time.sleep(0.1)
        assert self.mode == controller_status_t.MODE_IDLE, self.describe()

    def close(self) -> None:
        for process in self.processes.values():
            if process.poll() is None:
                process.terminate()
        for process in self.processes.values():
            try:
                process.wait(timeout=5)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        self.user.close()
