"""Mutants that no test finds, each with the reason why none needs to: survivors.yaml."""

from pathlib import Path

import yaml

from limber.errors import InputError
from limber.paths import ROOT
from limber_qa.mutation.rewrite import Mutant

PATH = ROOT / "tests" / "mutation" / "survivors.yaml"
_FIELDS = ("function", "at", "to", "reason")

Key = tuple[str, str, str, str]  # as Mutant.key


def load(path: Path = PATH) -> dict[Key, str]:
    """Key -> reason. A list for each file; `to` may be a list, too."""
    content = yaml.safe_load(path.read_text(encoding="utf-8")) or {}
    reasons: dict[Key, str] = {}
    for file, entries in content.items():
        for entry in entries:
            if sorted(entry) != sorted(_FIELDS) or not str(entry["reason"]).strip():
                raise InputError(f"{path.name}: {file}: each entry has {', '.join(_FIELDS)}")
            become = entry["to"] if isinstance(entry["to"], list) else [entry["to"]]
            for to in become:
                key = (file, entry["function"], entry["at"], str(to))
                if key in reasons:
                    raise InputError(f"{path.name}: twice: {entry['at']} -> {to} in {file}")
                reasons[key] = entry["reason"]
    return reasons


def stale(reasons: dict[Key, str], mutants: list[Mutant], files: set[str]) -> list[Key]:
    """Listed, but there is no such mutant any more."""
    known = {mutant.key for mutant in mutants}
    return [key for key in reasons if key[0] in files and key not in known]


def as_yaml(mutants: list[Mutant], reason: str) -> str:
    """Entries for `mutants`, to be given a reason each."""
    content: dict[str, dict[tuple[str, str], list[str]]] = {}
    for mutant in mutants:
        places = content.setdefault(mutant.file, {})
        places.setdefault((mutant.function, mutant.at), []).append(mutant.to)
    listed = {
        file: [
            {"function": function, "at": at, "to": to if len(to) > 1 else to[0], "reason": reason}
            for (function, at), to in places.items()
        ]
        for file, places in content.items()
    }
    return yaml.safe_dump(listed, allow_unicode=True, sort_keys=False, width=400)
