"""Scripts that talk to a running stack.

    from limber.client import Client

    with Client("openarm") as arm:
        arm.mode("active")
        arm.gains(law="cartesian_impedance", K_x_translation_N_per_m=300, ramp_s=0.2)
        arm.goal(offset_m=[0, 0, 0.05], duration_s=2)

The words are those of a scenario's timeline (scenarios/README.md), read and checked by the same
code. A call returns when the controller has taken the request, and raises `RefusedError` if it has
not.
"""

import json
import subprocess
from contextlib import suppress
from types import TracebackType
from typing import Any

from limber.errors import RunError
from limber.paths import program


class RefusedError(RunError):
    """The request was wrong, nobody was there to take it, or the controller would not."""


class Client:
    """One lease on the arm; gains build on each other, the first on robot.yaml.

    `client` is the lease's number; without one it is that of `limber ask`.
    """

    def __init__(self, robot: str = "openarm", client: int | None = None) -> None:
        lease = [] if client is None else ["--client", str(client)]
        self._process = subprocess.Popen(
            [str(program("limber-ask")), "--robot", robot, *lease],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            bufsize=1,
        )

    def mode(self, mode: str) -> None:
        """idle, hold, active, stop, acknowledge or release."""
        self.ask("mode", mode)

    def gains(self, **values: Any) -> None:
        """Law, numbers, choices and settings; N/m, N m/rad, s as in their names."""
        self.ask("gains", values)

    def goal(self, **values: Any) -> None:
        self.ask("goal", values)

    def push(self, **values: Any) -> None:
        """A hand on the simulated arm: force_N, torque_Nm, for_s, ramp_s, link."""
        self.ask("push", values)

    def ask(self, kind: str, value: Any) -> None:
        """Any entry of a timeline, such as ask("wall", "off")."""
        assert self._process.stdin is not None and self._process.stdout is not None
        try:
            self._process.stdin.write(json.dumps({kind: value}) + "\n")
            answer = self._process.stdout.readline().strip()
        except BrokenPipeError:
            answer = ""
        if answer != "ok":
            raise RefusedError(answer.removeprefix("error: ") or "limber-ask ended")

    def close(self) -> None:
        """Gives the lease back and ends."""
        if self._process.poll() is not None:
            return
        with suppress(RefusedError):  # somebody else has it, or nobody is there
            self.mode("release")
        self._process.communicate()

    def __enter__(self) -> "Client":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
