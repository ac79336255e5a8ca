"""A figure of `limber dev bench`, its peer of the same run, and what is asked of it."""

from dataclasses import asdict, dataclass
from typing import Any

from rich.table import Table

MICROSECONDS = "µs"


@dataclass(frozen=True)
class Figure:
    """What was measured and its peer's: a duration in ns, shown in µs, or else in `unit`.

    The ratio must not exceed the goal, if there is one; without a peer (""), the figure itself.
    """

    name: str
    own: float
    peer: str = ""
    peers: float | None = None
    goal: float | None = None
    unit: str = MICROSECONDS

    @property
    def ratio(self) -> float | None:
        return self.own / self.peers if self.peers else None

    @property
    def verdict(self) -> str:
        if self.peer and self.peers is None:
            return "peer not installed"
        if self.goal is None:
            return ""
        most = self.goal if self.peers is None else self.goal * self.peers
        return "met" if self.own <= most else "missed"

    def as_row(self) -> dict[str, Any]:
        """What makes it again: Figure(**row)."""
        return asdict(self)

    def as_json(self) -> dict[str, Any]:
        unit = "ns" if self.unit == MICROSECONDS else self.unit
        return {**asdict(self), "unit": unit, "ratio": self.ratio, "verdict": self.verdict}

    def shown(self, value: float | None) -> str:
        if value is None:
            return ""
        return f"{value / 1000:.2f}" if self.unit == MICROSECONDS else f"{value:.10g}"


def table(found: list[Figure]) -> Table:
    drawn = Table("figure", "its", "unit", "peer", "peer's", "ratio", "goal", "verdict")
    for figure in found:
        drawn.add_row(
            figure.name,
            figure.shown(figure.own),
            figure.unit,
            figure.peer,
            figure.shown(figure.peers),
            "" if figure.ratio is None else f"{figure.ratio:.2f}",
            "" if figure.goal is None else f"{figure.goal:.2f}",
            figure.verdict,
        )
    return drawn
