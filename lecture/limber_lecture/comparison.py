"""One line of an experiment: what a formula predicts, what was measured, and whether they agree."""

import math
from dataclasses import asdict, dataclass
from typing import Any

from limber.errors import InputError

KINDS = ("relative", "absolute", "at_most", "at_least")


@dataclass(frozen=True)
class Comparison:
    """`tolerance` is a fraction of the prediction for `relative`, in `unit` for the other kinds.

    `at_most` and `at_least` take `predicted` as the bound. A value that is not finite never passes.
    """

    name: str
    predicted: float
    measured: float
    unit: str
    tolerance: float
    kind: str = "relative"

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise InputError(
                f"check '{self.name}': kind '{self.kind}'; allowed: {', '.join(KINDS)}"
            )
        if not 0 <= self.tolerance < math.inf:
            raise InputError(f"check '{self.name}': tolerance {self.tolerance}; expected 0 or more")
        if self.kind == "relative" and self.predicted == 0:
            raise InputError(f"check '{self.name}': nothing is relative to 0; use absolute")

    @property
    def passed(self) -> bool:
        if not (math.isfinite(self.predicted) and math.isfinite(self.measured)):
            return False
        off = float(self.measured) - float(self.predicted)
        return bool(
            {
                "relative": abs(off) <= self.tolerance * abs(self.predicted),
                "absolute": abs(off) <= self.tolerance,
                "at_most": off <= self.tolerance,
                "at_least": -off <= self.tolerance,
            }[self.kind]
        )

    def as_json(self) -> dict[str, Any]:
        """JSON has no number for NaN or infinity: they become null."""
        content = asdict(self)
        for key in ("predicted", "measured"):
            content[key] = float(content[key]) if math.isfinite(content[key]) else None
        return {**content, "tolerance": float(self.tolerance), "pass": self.passed}


def near_zero(name: str, measured: float, unit: str, tolerance: float) -> Comparison:
    """What should not be there at all."""
    return Comparison(name, 0.0, measured, unit, tolerance, "absolute")


def at_most(
    name: str, bound: float, measured: float, unit: str = "", margin: float = 0.0
) -> Comparison:
    return Comparison(name, bound, measured, unit, margin, "at_most")


def at_least(
    name: str, bound: float, measured: float, unit: str = "", margin: float = 0.0
) -> Comparison:
    return Comparison(name, bound, measured, unit, margin, "at_least")


def ideal_and_bus(
    name: str,
    predicted: float,
    ideal: float,
    bus: float,
    unit: str,
    tolerance: float,
    kind: str = "relative",
) -> list[Comparison]:
    """One prediction, measured on the equations of the joint and on the robot on its bus."""
    return [
        Comparison(f"{name}, {where}", predicted, measured, unit, tolerance, kind)
        for where, measured in (("ideal", ideal), ("bus", bus))
    ]
