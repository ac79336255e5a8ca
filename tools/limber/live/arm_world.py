"""What a script does to a simulated arm: pushes, a wall, a payload."""

from typing import Any

from numpy.typing import ArrayLike

from limber.errors import InputError
from limber.live import request_messages
from limber.live.arm_base import ArmBase


class World(ArmBase):
    """The simulated world. InputError if the arm has real motors."""

    def push(
        self,
        force_N: ArrayLike | None = None,
        torque_Nm: ArrayLike | None = None,
        *,
        for_s: float = 1.0,
        ramp_s: float = 0.0,
        link: str = "",
        number: int = 1,
    ) -> None:
        """Pushes the simulated arm at a link, the tip if none is named, base axes; does not wait.

        `for_s` includes both edges of `ramp_s`. A push of the same `number` replaces one before.
        """
        message = request_messages.push(force_N, torque_Nm, for_s, ramp_s, link, number)
        self._post(message, "push")

    def wall(
        self,
        point_m: ArrayLike,
        normal: ArrayLike,
        stiffness_N_per_m: float = 20000.0,
        damping_Ns_per_m: float = 100.0,
    ) -> None:
        """Puts a wall through a point, base frame, its normal towards free space, to the simulated
        arm.
        """
        message = request_messages.wall(point_m, normal, stiffness_N_per_m, damping_Ns_per_m)
        self._post(message, "wall")

    def no_wall(self) -> None:
        """Takes the wall away."""
        self._post(request_messages.no_wall(), "wall")

    def payload(self, mass_kg: float, position_m: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        """A point mass at the simulated tip, kg, in tip axes, m; 0 kg takes it away."""
        self._post(request_messages.payload(mass_kg, position_m), "payload")

    def _post(self, message: Any, what: str) -> None:
        if not self.simulated:
            raise InputError(f"a {what} acts on a simulated arm only; {self.name} has real motors")
        self._port.post(message)
