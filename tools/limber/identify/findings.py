"""What an identification found: numbers with standard errors, refusals, and pictures of the fit."""

from dataclasses import dataclass, field

import numpy as np

from limber.errors import InputError


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
    """`refused`: joint -> why the log does not tell."""

    subject: str
    values: list[Value] = field(default_factory=list)
    refused: dict[str, str] = field(default_factory=dict)
    panels: list[Panel] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def require_something(self) -> None:
        if not self.values:
            reasons = "; ".join(f"{joint}: {reason}" for joint, reason in self.refused.items())
            raise InputError(f"this log cannot tell the {self.subject}. {reasons}")
