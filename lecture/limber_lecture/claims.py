"""The lecture's claims and how they fare: experiments/claims.yaml joined with the results."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from limber.errors import InputError
from limber.yaml_file import read_yaml
from limber_lecture.catalog import Experiment
from limber_lecture.run_one import ABOUT, RESULT

VERDICTS = ("holds", "holds with limits", "does not hold")
NOT_MEASURED, PARTLY, NOT_CONFIRMED = "not yet measured", "partly measured", "not confirmed"


@dataclass(frozen=True)
class Claim:
    """`shown_by`: experiment -> how the name of the check to show starts."""

    section: str
    claim: str
    verdict: str
    because: str
    shown_by: dict[str, str]


@dataclass(frozen=True)
class StoredResult:
    """What a run of an experiment left in its folder; `rows` as in result.json."""

    folder: Path
    rows: list[dict[str, Any]]
    about: dict[str, Any]

    @property
    def good(self) -> int:
        return sum(row["pass"] for row in self.rows)

    @property
    def passed(self) -> bool:
        return bool(self.rows) and self.good == len(self.rows)


def load_claims(path: Path) -> tuple[dict[str, str], list[Claim]]:
    """Titles of the sections in order, and the claims."""
    content = read_yaml(path)
    try:
        claims = [Claim(**entry) for entry in content["claims"]]
        sections = {str(key): str(title) for key, title in content["sections"].items()}
    except (KeyError, TypeError, AttributeError) as error:
        raise InputError(f"{path}: {error} is missing or wrong") from error
    for claim in claims:
        if claim.verdict not in VERDICTS:
            allowed = ", ".join(VERDICTS)
            raise InputError(f"{path}: verdict '{claim.verdict}'; allowed: {allowed}")
        if claim.section not in sections:
            raise InputError(f"{path}: section '{claim.section}'; there are {', '.join(sections)}")
    return sections, claims


def load_results(out: Path, experiments: list[Experiment]) -> dict[str, StoredResult]:
    """Of those that have been run."""
    results = {}
    for experiment in experiments:
        folder = out / experiment.id
        if not (folder / RESULT).is_file():
            continue
        try:
            rows, about = (
                json.loads((folder / name).read_text("utf-8")) for name in (RESULT, ABOUT)
            )
        except (OSError, json.JSONDecodeError) as error:
            raise InputError(f"{folder}: {error}; run {experiment.id} again") from error
        results[experiment.id] = StoredResult(folder, rows, about)
    return results


def verdict(claim: Claim, results: dict[str, StoredResult]) -> str:
    """The claim's own verdict stands when all of its experiments have been run and agree."""
    there = [results[key] for key in claim.shown_by if key in results]
    if not there:
        return NOT_MEASURED
    if not all(result.passed for result in there):
        return NOT_CONFIRMED
    return claim.verdict if len(there) == len(claim.shown_by) else PARTLY


def shown(rows: list[dict[str, Any]], start: str) -> dict[str, Any]:
    """The check whose number stands for the claim."""
    return next((row for row in rows if row["name"].startswith(start)), rows[0])
