"""What can go wrong with a running arm, each with its cause: all are `RunError`s."""

from limber.errors import RunError


class NoStackError(RunError):
    """No message of a driver or controller within a second, or that of another robot."""


class StackLostError(RunError):
    """Driver or controller is silent, or answers no request."""


class RefusedError(RunError):
    """The controller refused a request, and nothing has changed.

    `code`: such as request.LEASE, explained in docs/troubleshooting.md; `reason`: with its numbers.
    """

    def __init__(self, code: str, reason: str, remedy: str = "") -> None:
        super().__init__(f"refused: {code}: {reason}" + (f"; to do: {remedy}" if remedy else ""))
        self.code = code
        self.reason = reason


class FaultError(RunError):
    """The arm is in FAULT or ESTOP. `faults`: the causes in words."""

    def __init__(self, mode: str, faults: list[str]) -> None:
        causes = " ".join(faults) or "the cause is gone."
        super().__init__(f"the arm is in {mode.upper()}: {causes} Then: arm.acknowledge()")
        self.faults = faults


class RecoveryError(RunError):
    """arm.recover() has not brought the arm back to a running law.

    `step`: wait, acknowledge, hold or active, whichever failed; `mode`: where the arm is now.
    """

    def __init__(self, step: str, mode: str, why: Exception) -> None:
        super().__init__(f"recovery stopped at {step!r}, the arm is in {mode.upper()}: {why}")
        self.step, self.mode = step, mode


class NotReachedError(RunError):
    """A motion has ended away from its goal.

    `distance_m`, `angle_rad`: what is missing at the tip; `distance_rad`: of the joint that is
    farthest away, after a joint goal (rad, or m for prismatic joints). Others are None.
    """

    def __init__(
        self,
        why: str,
        distance_m: float | None = None,
        angle_rad: float | None = None,
        distance_rad: float | None = None,
    ) -> None:
        missing = [
            f"{1e3 * distance_m:.1f} mm" if distance_m is not None else "",
            f"{angle_rad:.3f} rad" if angle_rad is not None else "",
            f"{distance_rad:.3f} rad at a joint" if distance_rad is not None else "",
        ]
        shown = " and ".join(text for text in missing if text)
        super().__init__(f"the goal was not reached, {shown} away: {why}")
        self.distance_m = distance_m
        self.angle_rad = angle_rad
        self.distance_rad = distance_rad


class WaitTimeoutError(RunError, TimeoutError):
    """The awaited state did not come within the time."""
