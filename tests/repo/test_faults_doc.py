"""Every fault of the table is noticed in time or bridged, and docs/bus.md has the table."""

import pytest

from limber.messages import constants
from limber.model.protocols import protocols
from limber_qa import faults_doc


@pytest.fixture(scope="module")
def rows():
    return faults_doc.reactions()


def test_every_fault_is_noticed_in_time_or_bridged(rows):
    for row in rows:
        for family, cell in row["families"].items():
            least, most = cell["cycles"]
            where = f"{row['name']} ({family})"
            if row["from_start"]:
                assert most > 0, where
                assert constants("joint_state_t", "FAULT_")[cell["cause"]] == "CONFIGURATION"
            elif row["most_cycles"]:
                assert least >= 1 and most <= row["most_cycles"], where
            else:
                assert most == -1, where
                assert any(cell[key] for key in faults_doc.COUNTERS), f"{where} is not counted"


def test_every_family_is_tried(rows):
    tried = [set(row["families"]) for row in rows]
    assert {entry.word for entry in protocols()} in tried
    assert len(rows) >= 20


def test_bus_md_has_the_table(rows, monkeypatch):
    monkeypatch.setattr(faults_doc, "reactions", lambda: rows)
    text = faults_doc.TABLE.path.read_text(encoding="utf-8")
    assert faults_doc.TABLE.updated(text) == text, "run: ./limber dev docs"
