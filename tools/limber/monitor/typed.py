"""Numbers that are typed beside a slider: sent, rounded or refused as a whole, and that is told."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import viser

from limber.monitor.field_values import show
from limber.monitor.page_link import PageLink

NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d{1,3})?")
Tell = Callable[[str, str, bool], None]  # name, words, good


@dataclass(frozen=True)
class Field:
    """`take` gets a number within low..high, with as many decimals as the slider has."""

    slider: viser.GuiSliderHandle
    name: str
    low: float
    high: float
    take: Callable[[float], None]


class TypedFields:
    """What the pages tell is typed, by slider."""

    def __init__(self, link: PageLink, tell: Tell) -> None:
        self._fields: dict[str, Field] = {}
        self._tell = tell
        link.on("typed", self._typed)

    def add(self, field: Field) -> None:
        self._fields[field.slider._impl.uuid] = field

    def refused(self, field: Field, value: Any) -> None:
        """A browser sent what is out of range: the slider goes back."""
        span = f"{field.low:g} to {field.high:g}"
        self._tell(field.name, f"{value} is not within {span}; nothing was sent", False)

    def _typed(self, _viewer: int, content: Any) -> None:
        field = self._fields.get(content["slider"])
        if field is None:
            return
        text = str(content["text"]).strip()
        if not NUMBER.fullmatch(text):
            self._tell(field.name, f"{text!r} is no number such as 0.5; nothing was sent", False)
            return
        value = float(text)
        if not field.low <= value <= field.high:
            self.refused(field, text)
            return
        rounded = round(value, field.slider.precision)
        if rounded != value:
            self._tell(field.name, f"{text} was rounded to {rounded:.12g}", True)
        show(field.slider, rounded)
        field.take(rounded)
