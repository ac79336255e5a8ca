"""Drive protocols: what robots/loader/protocols holds of each, as limber-check prints it."""

import json
from dataclasses import dataclass
from functools import cache
from math import inf

from limber.errors import InputError, RunError
from limber.paths import captured, program


@dataclass(frozen=True)
class Key:
    """A key of robot.yaml that motors or joints of one protocol have. Its first value is `factor`
    times the figure, at least `least`, or `word`; `found`: where an owner finds the true one;
    `others`: keys that may stand in its place.
    """

    section: str
    key: str
    others: list[str]
    what: str
    found: str
    least: float
    figure: str
    factor: float
    word: str

    def first(self, figures: dict[str, float]) -> float:
        """`figures`: peak_torque, speed, hold_kp, hold_kd, at the joint. Not of a word."""
        return max(self.factor * figures[self.figure], self.least) if self.figure else self.least


@dataclass(frozen=True)
class Protocol:
    """`word`: `protocol:` of a motor; `title`: its name in texts; `sample_point`: 0 if any will do;
    `limit_temperature_degC`: none if its drives report no temperature.
    """

    word: str
    title: str
    needs_fd: bool
    usually_fd: bool
    reports_link: bool
    rotary_only: bool
    hex_ids: bool
    id_found: str
    sample_point: float
    usual_gear_ratio: float
    joints_a_bus: int
    limit_temperature_degC: float | None
    required: list[Key]

    def keys(self, section: str) -> list[Key]:
        return [key for key in self.required if key.section == section]

    def most(self, name: str) -> float:
        """The largest value that its frames carry of position_rad, kp_Nm_per_rad, ...; inf if the
        protocol fixes none.
        """
        fixed = [key.least for key in self.required if key.key == name and not key.figure]
        return min(fixed, default=inf)


@cache
def protocols() -> tuple[Protocol, ...]:
    done = captured([str(program("limber-check")), "protocols"])
    if done.returncode != 0:
        raise RunError(f"limber-check does not list the drive protocols: {done.stderr.strip()}")
    listed = json.loads(done.stdout)["protocols"]
    keys = [[Key(**key) for key in entry.pop("required")] for entry in listed]
    return tuple(Protocol(**entry, required=own) for entry, own in zip(listed, keys, strict=True))


def protocol(word: str) -> Protocol:
    """By its word, or a beginning of it that no other protocol has. Raises InputError."""
    named = [entry for entry in protocols() if entry.word == word]
    found = named or [entry for entry in protocols() if entry.word.startswith(word)]
    if len(found) != 1:
        words = ", ".join(entry.word for entry in protocols())
        raise InputError(f"no drive protocol '{word}'; there are {words}")
    return found[0]
