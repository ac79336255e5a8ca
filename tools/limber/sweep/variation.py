"""`--vary KEY=VALUES`: one key of a scenario, and the values it takes."""

import math
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from limber.errors import InputError

FORMS = "KEY=LOW..HIGH, KEY=LOW..HIGH:log or KEY=A,B,C"
ALIASES = {  # shorter than what the scenario calls it
    "gains.K_x": "gains.K_x_translation_N_per_m",
    "payload_kg": "payload.mass_kg",
    "plant.payload_kg": "payload.mass_kg",
    "loss": "wire.loss",
    "bus_delay": "wire.delay_s",
    "delay": "plant_overrides.joints.*.link_encoder.delay_s",
}
UNITS = {"Nm": "N m", "Ns": "N s", "Nms": "N m s", "kgm2": "kg m²", "per": "/", "s2": "s²"}
UNITS |= {unit: unit for unit in ("N", "m", "s", "rad", "kg", "J", "A", "V", "W", "K")}


@dataclass(frozen=True)
class Variation:
    """A range from `low` to `high`, by its logarithm or in whole numbers if `how` is log or whole;
    or `values`, a list of one kind. `text`: as parse() takes it.
    """

    text: str
    key: str
    low: float = 0.0
    high: float = 0.0
    how: str = ""
    values: tuple[Any, ...] = ()

    def at(self, share: float) -> Any:
        """The value at a share, 0 to 1, of the way; each of a list, and each whole number, has the
        same part of it.
        """
        if self.values:
            return self.values[min(int(share * len(self.values)), len(self.values) - 1)]
        if self.how == "whole":
            return int(min(self.low + math.floor(share * (self.high - self.low + 1)), self.high))
        if self.how == "log":
            return self.low * (self.high / self.low) ** share
        return self.low + share * (self.high - self.low)


def parse(text: str) -> Variation:
    """Raises InputError with what is expected."""
    key, _, words = text.partition("=")
    key = ALIASES.get(key, key)
    values, _, how = words.partition(":")
    if not (key and values) or how not in ("", "log", "whole"):
        raise InputError(f"--vary {text}: expected {FORMS}")
    meant = f"{key}={words}"
    if ".." not in values:
        listed = tuple(_value(word) for word in values.split(","))
        if len({float if type(value) is int else type(value) for value in listed}) > 1:
            raise InputError(f"--vary {text}: expected numbers, or true and false, or words")
        return Variation(meant, key, values=listed)
    low, high = (_value(word) for word in values.split("..", 1))
    for end in (low, high):
        if type(end) not in (int, float) or not math.isfinite(end):
            unit = f" in {unit_of(key)}, without it" if unit_of(key) else ""
            raise InputError(f"--vary {text}: '{end}'; expected a number{unit}")
    if not low < high or (how == "log" and not low > 0):
        raise InputError(f"--vary {text}: expected LOW below HIGH, and LOW:log above 0")
    return Variation(meant, key, float(low), float(high), how)


def unit_of(key: str) -> str:
    """At the end of a key's name: N/m of K_x_translation_N_per_m; empty if it names none."""
    words = [word for word in key.split(".") if not word.isdigit()][-1].split("_")
    first = len(words)
    while first > 1 and words[first - 1] in UNITS:
        first -= 1
    return " ".join(UNITS[word] for word in words[first:]).replace(" / ", "/")


def _value(word: str) -> Any:
    """As YAML has it: a number, true, false, or a word."""
    if word in ("true", "false"):
        return word == "true"
    for kind in (int, float):
        with suppress(ValueError):
            return kind(word)
    return word
