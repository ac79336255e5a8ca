"""Where robot.yaml has each joint's motor and sign, and what to write there instead."""

from dataclasses import dataclass
from pathlib import Path

import yaml

from limber.errors import InputError
from limber.joint_check.judge import Finding, Verdict

OF_THE_MOTOR = ("motor", "bus", "id", "reply_id")  # go with a motor from joint to joint


@dataclass(frozen=True)
class Entry:
    value: str  # as it is written
    line: int


@dataclass(frozen=True)
class Change:
    """`line`: of the key, or of the joint if it has no such key yet."""

    key: str
    line: int
    now: str
    write: str


class JointKeys:
    """The keys of one joint. `line`: of its name."""

    def __init__(self, name: str, line: int, node: yaml.MappingNode) -> None:
        self.name, self.line = name, line
        self.entries = {
            key.value: Entry(value.value, key.start_mark.line + 1)
            for key, value in node.value
            if isinstance(value, yaml.ScalarNode)
        }

    @property
    def sign(self) -> int:
        return int(self.value("sign") or "1")

    def value(self, key: str) -> str:
        """Empty if there is no such key."""
        entry = self.entries.get(key)
        return "" if entry is None else entry.value

    def change(self, key: str, write: str) -> Change:
        entry = self.entries.get(key)
        line, now = (self.line, "") if entry is None else (entry.line, entry.value)
        return Change(f"joints.{self.name}.{key}", line, now, write)

    def where(self) -> str:
        """Such as "id 3 on arm"."""
        return f"id {self.value('id')} on {self.value('bus')}"


def read_keys(path: Path, names: list[str]) -> list[JointKeys]:
    """Of the joints of robot.yaml, in the order of `names`."""
    root = yaml.compose(path.read_text(encoding="utf-8"))
    entries = root.value if isinstance(root, yaml.MappingNode) else []
    joints = next((v for k, v in entries if k.value == "joints"), None)
    found = {k.value: (k, v) for k, v in joints.value} if joints is not None else {}
    missing = [name for name in names if name not in found]
    if missing:
        raise InputError(f"{path}: joints.{missing[0]} is missing")
    return [JointKeys(name, found[name][0].start_mark.line + 1, found[name][1]) for name in names]


def changes(keys: list[JointKeys], joint: int, way: int, finding: Finding) -> list[Change]:
    """What to write at `joint`, which was turned `way`; nothing if it is right or unknown."""
    own = keys[joint]
    if finding.verdict is Verdict.SIGN:
        return [own.change("sign", str(-own.sign))]
    if finding.verdict is not Verdict.EXCHANGED:
        return []
    other = keys[finding.joints[0]]
    found = [
        own.change(key, other.value(key))
        for key in OF_THE_MOTOR
        if other.value(key) and own.value(key) != other.value(key)
    ]
    sign = other.sign * (1 if finding.moved * way > 0 else -1)
    return found + ([own.change("sign", str(sign))] if sign != own.sign else [])


def explanation(keys: list[JointKeys], joint: int, finding: Finding) -> str:
    """What is wrong, in a sentence; empty if nothing is."""
    own = keys[joint]
    if finding.verdict is Verdict.SIGN:
        return f"{own.name} turned the other way than its reading: its sign is wrong."
    if finding.verdict is Verdict.EXCHANGED:
        other = keys[finding.joints[0]]
        places = " and ".join(
            f"joints.{k.name}.id (line {k.entries['id'].line})" for k in (own, other)
        )
        return (
            f"{other.name} moved instead: the motor on {own.name} is the one that robot.yaml has "
            f"at {other.name}. The two are exchanged: {places}."
        )
    if finding.verdict is Verdict.LINK:
        return (
            f"{own.name}'s motor moved, but the encoder on its link by another angle: it counts "
            "the other way, or belongs to another joint. Its direction is set in the drive."
        )
    if finding.verdict is Verdict.SEVERAL:
        moved = ", ".join(keys[i].name for i in sorted(finding.joints))
        return f"{moved} moved at once: hold the others and turn {own.name} alone."
    return ""


def change_words(change: Change, file: str = "robot.yaml") -> str:
    if change.now:
        return f"{change.key}: {change.write} instead of {change.now} ({file}:{change.line})"
    return f"{change.key}: {change.write}, a new key ({file}:{change.line})"
