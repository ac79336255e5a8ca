"""What `limber dev mutation` prints."""

from collections import Counter

from rich.console import Console

from limber.tables import table
from limber_qa.mutation.campaign import Result
from limber_qa.mutation.rewrite import Mutant


def show(result: Result, console: Console) -> None:
    """A row a file, then what is wrong."""
    columns: dict[str, Counter[str]] = {}
    survived = set(result.survived())
    for mutant in result.verdicts:
        count = columns.setdefault(mutant.file, Counter())
        count["mutants"] += 1
        count["killed"] += mutant not in survived
        count["survived"] += mutant in survived
        count["listed"] += mutant in survived and mutant.key in result.reasons
    words = ("mutants", "killed", "survived", "listed")
    shown = table("<file", *(f">{word}" for word in words))
    total = sum(columns.values(), Counter())
    for file, count in [*columns.items(), ("all", total)]:
        shown.add_row(file, *(str(count[word]) for word in words))
    console.print(shown)
    _list(console, "survived, and not in survivors.yaml", result.unlisted(), result)
    _list(console, "in survivors.yaml, but killed", result.listed_but_killed(), result)
    for file, function, at, to in result.stale:
        _print(console, f"in survivors.yaml, but no mutant: {file}: {function}: {at} -> {to}")


def _list(console: Console, title: str, mutants: list[Mutant], result: Result) -> None:
    for mutant in mutants:
        by = result.verdicts[mutant].by
        note = " (reached by no test)" if mutant in result.unreached else f" ({by})" if by else ""
        _print(console, f"{title}: {mutant.file}:{mutant.line}: {mutant.at} -> {mutant.to}{note}")


def _print(console: Console, text: str) -> None:
    console.print(text, markup=False, highlight=False, emoji=False, soft_wrap=True)
