"""One table of faults, refusals, verdicts and limits: complete, and the docs have it."""

import re

import pytest

from limber.messages import constants, table_file
from limber.paths import ROOT
from limber.problems import groups
from limber_qa import troubleshooting_doc

DOC = (ROOT / "docs" / "troubleshooting.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("key", groups())
def test_every_constant_is_a_problem_or_fine_and_only_one_of_them(key):
    group = groups()[key]
    written = sorted([*group.problems, *group.fine])
    assert written == sorted(constants(group.message, group.prefix).values())


def test_every_set_of_constants_that_may_be_a_problem_has_a_group():
    wanted = {
        *("joint_state_t.FAULT_", "joint_state_t.JOINT_", "joint_state_t.SENSOR_"),
        *("joint_state_t.STOP_", "controller_status_t.REASON_", "controller_status_t.LIMIT_"),
        *("driver_status_t.VERDICT_", "driver_status_t.BUS_", "request_answer_t.REFUSED_"),
    }
    assert {f"{group.message}.{group.prefix}" for group in groups().values()} == wanted


def test_every_entry_is_whole():
    for group in groups().values():
        for problem in group.problems.values():
            for clause in (problem.what, problem.remedy, *problem.causes):
                assert clause.strip() == clause and clause and not clause.endswith("."), problem
            assert problem.causes, problem.code
    table = table_file("problems.yaml")
    keys = {
        key for group in table["groups"].values() for e in group["problems"].values() for key in e
    }
    assert keys == {"what", "causes", "do"}


def test_the_doc_has_the_table():
    assert troubleshooting_doc.TABLE.updated(DOC) == DOC, "run: ./limber dev docs"


def test_every_link_within_the_doc_leads_to_a_code():
    anchors = {problem.anchor for group in groups().values() for problem in group.problems.values()}
    linked = set(re.findall(r"\]\(#([\w-]+)\)", DOC))
    assert linked == anchors


def test_every_code_in_the_texts_exists():
    """A sentence may send its reader to another code."""
    known = {problem.code for group in groups().values() for problem in group.problems.values()}
    names = "|".join(groups())
    for path in (ROOT / "lcmtypes" / "problems.yaml", *(ROOT / "docs").glob("*.md")):
        text = path.read_text(encoding="utf-8")
        found = set(re.findall(rf"\b(?:{names})\.[A-Z][A-Z_]+\b", text))
        assert found <= known, path
