"""Requests to a running stack, for scripts.

    from limber.live.client import Client

    with Client("openarm") as arm:
        arm.mode("active")
        arm.gains(law="cartesian_impedance", K_x_translation_N_per_m=300, ramp_s=0.2)
        arm.goal(offset_m=[0, 0, 0.05], duration_s=2)

Requests are entries of a scenario's timeline (scenarios/README.md), read and checked by the same
code. A call returns when the controller has accepted the request, and raises `RefusedError` if it
has not.
"""

import json
import subprocess
from contextlib import AbstractContextManager, suppress
from typing import Any

from limber.errors import RunError
from limber.paths import program


class RefusedError(RunError):
    """The request was wrong, no controller answered, or the controller refused it."""


class Client(AbstractContextManager):
    """One lease on the arm. Gains build on those of the call before, the first on robot.yaml.

    `client` is the number of the lease; the default is that of `limber send`.
    """

    def __init__(self, robot: str = "openarm", client: int | None = None) -> None:
        lease = [] if client is None else ["--client", str(client)]
        self._process = subprocess.Popen(
            [str(program("limber-send")), "--robot", robot, *lease],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            bufsize=1,
        )

    def mode(self, mode: str) -> None:
        """idle, hold, active, stop, acknowledge or release."""
        self.send("mode", mode)

    def gains(self, **values: Any) -> None:
        """Law, numbers, choices and settings; each key names its unit."""
        self.send("gains", values)

    def goal(self, **values: Any) -> None:
        self.send("goal", values)

    def push(self, **values: Any) -> None:
        """Pushes the simulated arm: force_N, torque_Nm, for_s, ramp_s, link."""
        self.send("push", values)

    def send(self, kind: str, value: Any) -> None:
        """Sends any entry of a timeline, such as send("wall", "off")."""
        assert self._process.stdin is not None and self._process.stdout is not None
        try:
            self._process.stdin.write(json.dumps({kind: value}) + "\n")
            answer = self._process.stdout.readline().strip()
        except BrokenPipeError:
            answer = ""
        if answer != "ok":
            raise RefusedError(answer.removeprefix("error: ") or "limber-send ended")

    def close(self) -> None:
        """Releases the lease and ends limber-send."""
        if self._process.poll() is not None:
            return
        with suppress(RefusedError):  # another client has it, or no controller answers
            self.mode("release")
        self._process.communicate()

    def __exit__(self, *_error: object) -> None:
        self.close()
