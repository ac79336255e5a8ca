"""What the controller can run on this arm: its laws with numbers and choices, as it lists them."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from limber.model.gains_table import listing


@dataclass(frozen=True)
class Gain:
    """One number, choice or matrix of `gains:`. `kind`: number, blocks, joints, tip_matrix,
    choice, switch or periods; `standard` is "robot.yaml" where the robot's own value counts.
    """

    key: str
    meaning: str
    kind: str
    unit: str
    words: tuple[str, ...]
    low: float
    high: float
    standard: Any

    @property
    def label(self) -> str:
        """The key without its unit, which stands behind it as people write it."""
        suffix = self.unit.replace(" ", "").replace("/", "_per_").replace("²", "2")
        name = self.key.removesuffix(f"_{suffix.removeprefix('1_')}")
        return f"{name.replace('_', ' ')} {self.unit}".strip()

    @property
    def hint(self) -> str:
        span = f" [{self.low:g} to {self.high:g} {self.unit}]" if self.high > self.low else ""
        return f"{self.key}: {self.meaning}{span}".replace("`", "")


@dataclass(frozen=True)
class Law:
    name: str
    summary: str
    goal: str  # pose, joints, joints and wrench, smooth joints or none
    refusal: str  # why this arm cannot run it; empty: it can
    parameters: tuple[Gain, ...]


@dataclass(frozen=True)
class LawList:
    gains: tuple[Gain, ...]
    laws: tuple[Law, ...]

    def law(self, number: int) -> Law | None:
        return self.laws[number] if 0 <= number < len(self.laws) else None

    def uses_K_x(self, number: int) -> bool:
        law = self.law(number)
        return law is not None and law.goal == "pose"

    @property
    def usable(self) -> list[str]:
        return [law.name for law in self.laws if not law.refusal]


def list_laws(robot: Path) -> LawList:
    return parse(listing(str(robot)))


def parse(listed: dict[str, Any]) -> LawList:
    laws = [
        Law(
            row["name"],
            row["summary"],
            row["goal"],
            row.get("refusal") or "",
            tuple(map(_gain, row["parameters"])),
        )
        for row in listed["laws"]
    ]
    return LawList(tuple(map(_gain, listed["gains"])), tuple(laws))


def _gain(row: dict[str, Any]) -> Gain:
    words = tuple(word["word"] for word in row.get("words", ()))
    return Gain(
        row["key"],
        row["meaning"],
        row["kind"],
        row.get("unit", ""),
        words,
        float(row.get("low", 0.0)),
        float(row.get("high", 0.0)),
        row.get("default"),
    )
