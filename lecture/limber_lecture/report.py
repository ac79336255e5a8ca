"""`limber lecture experiment report`: one self-contained page, in the order of the lecture."""

import base64
import html
from pathlib import Path
from typing import Any

from limber.errors import InputError
from limber.paths import ASSETS, ROOT
from limber_lecture.catalog import Experiment, catalog
from limber_lecture.claims import (
    NOT_MEASURED,
    Claim,
    StoredResult,
    load_claims,
    load_results,
    shown,
    verdict,
)
from limber_lecture.context import PICTURE
from limber_lecture.run_one import numbers, tolerance

text = html.escape


def write(out: Path, root: Path | None = None) -> Path:
    """Writes OUT/report.html from what the experiments left in OUT."""
    root = root or ROOT / "lecture" / "experiments"
    experiments = catalog(root)
    results = load_results(out, experiments)
    if not results:
        raise InputError(
            f"{out} holds no results: run `limber lecture experiment run all --out {out}`"
        )
    path = out / "report.html"
    sections, claims = load_claims(root / "claims.yaml")
    path.write_text(page(sections, claims, experiments, results), encoding="utf-8")
    return path


def page(
    sections: dict[str, str],
    claims: list[Claim],
    experiments: list[Experiment],
    results: dict[str, StoredResult],
) -> str:
    parts = {
        "SUMMARY": _summary(experiments, results),
        "CLAIMS": _claims(sections, claims, results) + _others(claims, experiments, results),
        "DETAILS": _details(sections, experiments, results),
    }
    filled = (ASSETS / "report.html").read_text(encoding="utf-8")
    for key, value in parts.items():
        filled = filled.replace(f"@{key}@", value)
    return filled


def _summary(experiments: list[Experiment], results: dict[str, StoredResult]) -> str:
    checks = sum(len(result.rows) for result in results.values())
    good = sum(result.good for result in results.values())
    dates = sorted(result.about["date"] for result in results.values())
    when = dates[0] if dates[0] == dates[-1] else f"{dates[0]} to {dates[-1]}"
    versions = ", ".join(sorted({result.about["version"] for result in results.values()}))
    return (
        f"{len(results)} of {len(experiments)} experiments run, {good} of {checks} numbers within "
        f"tolerance. limber {text(versions)}, {text(when)}. Everything is simulated with a fixed "
        "seed in lock step, so the numbers do not depend on the machine."
    )


def _claims(sections: dict[str, str], claims: list[Claim], results: dict[str, StoredResult]) -> str:
    rows = []
    for section, title in sections.items():
        rows.append(f'<tr class="section"><th colspan="3">{text(section)} {text(title)}</th></tr>')
        rows += [_claim(claim, results) for claim in claims if claim.section == section]
    return "\n".join(rows)


def _others(
    claims: list[Claim], experiments: list[Experiment], results: dict[str, StoredResult]
) -> str:
    """What was measured on top of the lecture's claims."""
    named = {key for claim in claims for key in claim.shown_by}
    rows = [
        f"<tr><td>{text(item.claim)}.</td><td></td>"
        f"<td>{_evidence(item.id, '', results[item.id])}</td></tr>"
        for item in experiments
        if item.id in results and item.id not in named
    ]
    title = '<tr class="section"><th colspan="3">Not in the lecture, but needed</th></tr>'
    return "\n".join([title, *rows]) if rows else ""


def _claim(claim: Claim, results: dict[str, StoredResult]) -> str:
    word = verdict(claim, results)
    lines = [
        _evidence(key, start, results.get(key)) for key, start in sorted(claim.shown_by.items())
    ]
    because = "" if word == NOT_MEASURED else f"<p>{text(claim.because)}</p>"
    return (
        f'<tr><td>{text(claim.claim)}{because}</td><td><span class="{word.replace(" ", "-")}">'
        f"{word}</span></td><td>{''.join(lines)}</td></tr>"
    )


def _evidence(key: str, start: str, result: StoredResult | None) -> str:
    if result is None:
        return f"<p>{key}: {NOT_MEASURED}</p>"
    row = shown(result.rows, start)
    predicted, measured = numbers(row)
    return (
        f'<p><a href="#{key}">{key}</a> {text(row["name"])}: predicted {text(predicted)}, '
        f"measured <b>{text(measured)}</b>; {result.good} of {len(result.rows)} numbers agree</p>"
    )


def _details(
    sections: dict[str, str], experiments: list[Experiment], results: dict[str, StoredResult]
) -> str:
    order = list(sections)
    known = [item for item in experiments if item.id in results]
    known.sort(key=lambda item: (order.index(item.section), item.id))
    return "\n".join(_detail(item, results[item.id]) for item in known)


def _detail(experiment: Experiment, result: StoredResult) -> str:
    rows = "\n".join(_check(row) for row in result.rows)
    image = base64.b64encode((result.folder / PICTURE).read_bytes()).decode("ascii")
    title, section = text(experiment.title), text(experiment.section)
    return (
        f'<section id="{experiment.id}"><h2>{experiment.id} {title}</h2>'
        f'<p class="claim">Section {section}: {text(experiment.claim)}.</p>'
        f'<img alt="{title}" src="data:image/png;base64,{image}">'
        f'<p class="plant">StoredResult on: {text(experiment.plant)}. '
        f"{result.good} of {len(result.rows)} numbers within tolerance.</p>"
        "<details><summary>All numbers</summary><table><thead><tr><th></th><th>predicted</th>"
        "<th>measured</th><th>tolerance</th><th></th></tr></thead><tbody>"
        f'{rows}</tbody></table></details><p><a href="#top">back to the claims</a></p></section>'
    )


def _check(row: dict[str, Any]) -> str:
    cells = [row["name"], *numbers(row), tolerance(row), "ok" if row["pass"] else "NO"]
    mark = "" if row["pass"] else ' class="failed"'
    return f"<tr{mark}>{''.join(f'<td>{text(cell)}</td>' for cell in cells)}</tr>"
