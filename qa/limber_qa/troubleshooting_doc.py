"""The codes in docs/troubleshooting.md, written from lcmtypes/problems.yaml."""

from limber.paths import ROOT
from limber.problems import Group, Problem, groups, sentence
from limber_qa.written_table import WrittenTable


def _problem(problem: Problem) -> list[str]:
    lines = [f"### {problem.code}", "", sentence(problem.what), ""]
    if problem.causes:
        lines += [*(f"- {cause}" for cause in problem.causes), ""]
    return [*lines, f"Remedy: {problem.remedy}.", ""]


def _group(group: Group) -> list[str]:
    lines = [f"## {group.title}", ""]
    if group.intro:
        lines += [group.intro, ""]
    lines += [f"Shown in: {group.shown}.", ""]
    for problem in group.problems.values():
        lines += _problem(problem)
    return lines


def _lines() -> list[str]:
    lines = []
    for key, group in groups().items():
        names = [f"[{name}](#{p.anchor})" for name, p in group.problems.items()]
        lines.append(f"- `{key}`: {', '.join(names)}")
    lines.append("")
    for group in groups().values():
        lines += _group(group)
    return lines[:-1]


TABLE = WrittenTable(ROOT / "docs" / "troubleshooting.md", "problems", _lines)
