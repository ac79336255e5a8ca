"""The running arm in a script: `from limber import Arm`."""

import atexit
from contextlib import AbstractContextManager, suppress
from typing import Any

from numpy.typing import ArrayLike

from limber.live.arm_errors import FaultError, RefusedError, StackLostError, WaitTimeoutError
from limber.live.arm_modes import Modes
from limber.live.arm_motions import Motions
from limber.live.arm_streams import Streams
from limber.live.arm_world import World
from limber.live.episodes import Episodes
from limber.live.gains_message import gains as gains_message
from limber.live.hand import Hand


class Arm(Modes, Motions, Streams, World, AbstractContextManager["Arm", None]):
    """The arm of the stack that runs on this machine.

        from limber import Arm

        with Arm() as arm:
            arm.activate()
            arm.move([0, 0, 0.05])
            print(arm.pose.p, arm.q)

    It finds the stack and its robot; `robot` refuses any other. The first request takes the lease,
    close() or the end of the block gives it back and leaves the arm held. Quantities are the
    newest, some milliseconds old. `client`: number of the lease, by default one of this process;
    that one is free when the process has ended. `url`: LCM address of another stack.

    Raises NoStackError if no stack runs. Later everything may raise StackLostError, and every
    request RefusedError.
    """

    def __init__(
        self, robot: str | None = None, client: int | None = None, url: str | None = None
    ) -> None:
        super().__init__(robot, client, url)
        self._hand = Hand(self._link, self._send)
        self._episodes = Episodes(self._link.receiver)
        atexit.register(self.close)

    @property
    def hand(self) -> Hand:
        """Requests to the hand, if there is one, and its state."""
        return self._hand

    @property
    def episodes(self) -> Episodes:
        """Marks of episodes in what is being recorded. Each call returns when a recorder has its
        mark in the file; RunError if none has.
        """
        return self._episodes

    def gains(self, law: str | None = None, ramp_s: float = 0.0, **keys: Any) -> None:
        """Changes law, numbers, choices and settings that are named; all else stays.

        Keys, units and words are those of scenarios/README.md, such as damping_ratio=0.9 or
        contact="joint_torque". Numbers change along a ramp of `ramp_s`, 0.1 s or more.
        """
        self._send(gains_message(len(self.joint_names), law, ramp_s, **keys))

    def soften(
        self,
        translation_N_per_m: ArrayLike,
        rotation_Nm_per_rad: ArrayLike | None = None,
        ramp_s: float = 0.5,
    ) -> None:
        """Sets the Cartesian stiffness, one number or one an axis, and waits for its ramp."""
        keys: dict[str, ArrayLike] = {"K_x_translation_N_per_m": translation_N_per_m}
        if rotation_Nm_per_rad is not None:
            keys["K_x_rotation_Nm_per_rad"] = rotation_Nm_per_rad
        taken_ns = self._send(gains_message(len(self.joint_names), None, ramp_s, **keys)).time_ns
        self.wait(until=lambda now: now.status["time_ns"] > taken_ns and "RAMP" not in now.limits)

    def close(self) -> None:
        """If this script has commanded the arm: leaves it held and gives the lease back."""
        atexit.unregister(self.close)
        try:
            # Gone, in FAULT, or another's by now: nothing that this script could still do.
            with suppress(StackLostError, FaultError, RefusedError, WaitTimeoutError):
                if self._requested and self.mode in ("active", "soft_stop"):
                    self.hold(timeout_s=5.0)
                if self._requested:
                    self.release()
        finally:
            self._requested = False
            for end in self._followers:
                end()
            self._link.close()

    def detach(self) -> None:
        """Ends this connection alone: the arm stays in its mode, and the lease with `client`."""
        self._requested = False
        self.close()

    def __exit__(self, *_error: object) -> None:
        self.close()
