"""What an identification found: numbers with standard errors, refusals, and pictures of the fit."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from limber.errors import InputError

LEAST_STD = 2.0  # standard errors from nothing that a proposal has to be
AGAINST_URDF = (
    "Joints without a torque sensor are measured against the weights in the URDF: check those "
    "first (identify gravity)."
)


@dataclass(frozen=True)
class Value:
    """`path`: keys in robot.yaml that should hold `proposed`; None: nothing is proposed."""

    joint: str
    name: str
    unit: str
    value: float
    std: float
    believed: float | None = None
    path: tuple[str, ...] | None = None
    proposed: float | None = None

    @property
    def certain(self) -> bool:
        """It stands out from nothing: what does not is never proposed."""
        return abs(self.value) >= LEAST_STD * self.std


@dataclass(frozen=True)
class Panel:
    """Samples as dots, laws as lines: name -> (x, y). `others`: y of a second kind of dots."""

    title: str
    x_label: str
    y_label: str
    x: np.ndarray
    y: np.ndarray
    lines: dict[str, tuple[np.ndarray, np.ndarray]]
    others: dict[str, np.ndarray] = field(default_factory=dict)


@dataclass
class Findings:
    """`refused`: joint -> why it cannot be identified from the log. `inertials`: link -> mass, kg,
    and centre of mass in its own frame, m, that the URDF should have.
    """

    subject: str
    values: list[Value] = field(default_factory=list)
    refused: dict[str, str] = field(default_factory=dict)
    panels: list[Panel] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    inertials: dict[str, tuple[float, np.ndarray]] = field(default_factory=dict)

    def proposals(self) -> Iterator[tuple[tuple[str, ...], float, Value]]:
        """What robot.yaml should hold: keys, number, and what was found."""
        for value in self.values:
            if value.path is not None and value.proposed is not None and value.certain:
                yield value.path, value.proposed, value

    def require_something(self) -> None:
        if not self.values:
            reasons = "; ".join(f"{joint}: {reason}" for joint, reason in self.refused.items())
            raise InputError(f"the {self.subject} cannot be identified from this log. {reasons}")
