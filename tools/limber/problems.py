"""Faults, refusals, verdicts and limits in words; the words are in lcmtypes/problems.yaml."""

from dataclasses import dataclass
from functools import cache
from typing import Any

from limber.messages import constants, table_file

MORE = "docs/troubleshooting.md"


@dataclass(frozen=True)
class Problem:
    """`code`: GROUP.NAME; `what` and `remedy`: clauses without a full stop."""

    code: str
    what: str
    causes: tuple[str, ...]
    remedy: str

    @property
    def anchor(self) -> str:
        return anchor(self.code)


@dataclass(frozen=True)
class Group:
    """The problems that one set of constants, such as joint_state_t.FAULT_, stands for."""

    key: str
    message: str
    prefix: str
    title: str
    intro: str
    shown: str
    fine: tuple[str, ...]
    problems: dict[str, Problem]


@cache
def groups() -> dict[str, Group]:
    return {
        key: _group(key, content) for key, content in table_file("problems.yaml")["groups"].items()
    }


def _group(key: str, content: dict[str, Any]) -> Group:
    message, prefix = content["constants"].split(".")
    found = {
        name: Problem(f"{key}.{name}", entry["what"], tuple(entry["causes"]), entry["do"])
        for name, entry in content["problems"].items()
    }
    fine = tuple(content.get("fine", ()))
    intro, shown = content.get("intro", ""), content["shown"]
    return Group(key, message, prefix, content["title"], intro, shown, fine, found)


def problem(group: str, value: int) -> Problem | None:
    """What a constant means; None if it is no problem. An unknown number is one, too."""
    known = groups()[group]
    name = constants(known.message, known.prefix).get(int(value))
    if name is None:
        return Problem(f"{group}.{int(value)}", "unknown to this version of limber", (), "")
    return known.problems.get(name)


def problems_of_bits(group: str, bits: int) -> list[Problem]:
    known = groups()[group]
    names = constants(known.message, known.prefix)
    set_bits = [name for bit, name in names.items() if int(bits) & bit]
    return [known.problems[name] for name in set_bits if name in known.problems]


def anchor(code: str) -> str:
    """Of the heading `### CODE`, as GitHub makes it."""
    return code.lower().replace(".", "")


def sentence(clause: str) -> str:
    return clause[:1].upper() + clause[1:] + "."
