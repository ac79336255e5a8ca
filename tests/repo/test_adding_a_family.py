"""A drive family costs the edits that docs/adding.md lists, and no others."""

import re
import subprocess

import yaml

from limber.model.protocols import protocols
from limber.paths import ROOT
from limber_qa.check_trace import drives

DOCUMENT = (ROOT / "docs" / "adding.md").read_text(encoding="utf-8")
SECTION = DOCUMENT.split("## A drive family")[1].split("\n## ")[0]
LISTS = set(re.findall(r"^\| `([^`]+)` \|", SECTION.split("Six edits:")[1], re.MULTILINE))
PRODUCT = ("common", "controller", "drivers", "lab", "robots/loader", "sim", "tools", "qa")
# Faults that only drives of one family can have, and the change of a reply that families.cc names.
PARTICULAR = (
    "qa/faults/bus_faults.cc",
    "qa/faults/feedback_faults.cc",
    "qa/faults/state_change.cc",
)


def test_six_lists_and_those_that_the_added_family_is_in():
    edits = yaml.safe_load((ROOT / "tests" / "added_family" / "edits.yaml").read_text())
    assert len(LISTS) == 6
    assert {edit["file"] for edit in edits} | {"docs/architecture.md"} == LISTS


def test_no_other_code_names_a_family():
    """Words of robot.yaml as text, and names of a family's classes and functions."""
    words = [entry.word for entry in protocols()]
    stems = {word.split("_")[0] for word in words}
    named = re.compile(
        "|".join([rf'"{word}"' for word in words] + [rf"\b(?:{'|'.join(stems)})(?:_\w+\(|::)"]),
        re.I,
    )
    found = []
    listed = subprocess.run(
        ["git", "ls-files", *PRODUCT], cwd=ROOT, capture_output=True, text=True, check=True
    )
    for name in listed.stdout.split():
        own = any(stem in name.lower() for stem in (*stems, "canopen", "mit."))
        if own or name in LISTS or name in PARTICULAR or not name.endswith((".cc", ".h", ".py")):
            continue
        for number, line in enumerate((ROOT / name).read_text(encoding="utf-8").splitlines(), 1):
            code = re.split(r"//|#", line)[0]
            if named.search(code) and "family: str" not in code:
                found.append(f"{name}:{number}: {line.strip()}")
    assert not found


def test_every_family_has_a_column_and_a_reader_of_its_own():
    table = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    for entry in protocols():
        assert re.search(rf"^\| \|.*`{entry.word}`", table, re.MULTILINE), entry.word
        assert drives.decoder(entry.word).states
