"""Which mutants are made of a source, what they are known by, and the list of survivors."""

import pytest

from limber.errors import InputError
from limber_qa.mutation import survivors, targets
from limber_qa.mutation.campaign import Result
from limber_qa.mutation.programs import RecordedTest, Verdict, _batches
from limber_qa.mutation.rewrite import rewrite


def changes(source: str) -> set[tuple[str, str]]:
    """(what is marked, what it becomes)"""
    _, mutants = rewrite(source, "a.cc", 0)
    return {(mutant.at.split("⟦")[1].split("⟧")[0], mutant.to) for mutant in mutants}


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("bool f(int a) { return a < g; }", {("<", "<="), ("<", ">=")}),
        ("bool f(int a) { return a == g; }", {("==", "!=")}),
        ("int f(int a) { return a + g; }", {("+", "-")}),
        ("int f() { return 7; }", {("7", "+ 1"), ("7", "- 1")}),
        ("int f() { return 0; }", {("0", "1")}),
        ("double f() { return 0.5; }", {("0.5", "* 1.1"), ("0.5", "* -1")}),
        ("int f() { return kMost; }", {("kMost", "the next"), ("kMost", "the one before")}),
        ("bool f() { return true; }", {("true", "false")}),
        ("bool f() { return a && b; }", {("a", "left out of &&"), ("b", "left out of &&")}),
        ("bool f() { return !a; }", {("!a", "a")}),
        ("void f() { if (a) b(); }", {("a", "its opposite"), ("b();", "left out")}),
        ("void f() { a += b; }", {("a += b;", "left out"), ("+=", "-=")}),
        ("int f() { return a ? b : c; }", {("a", "its opposite")}),
    ],
)
def test_what_an_expression_becomes(source, expected):
    assert changes(source) == expected


@pytest.mark.parametrize(
    "source",
    [
        "constexpr int kMost = 7;",
        "std::array<int, 4> a;",
        "enum class E { kA = 3 };",
        'static_assert(1 + 1 == 2, "");',
        "struct S { virtual int f() = 0; };",
        "// 1 + 1",
        '#include "a.h"',
    ],
)
def test_what_the_compiler_needs_is_left_alone(source):
    text, mutants = rewrite(source, "a.cc", 0)
    assert not mutants
    assert text.endswith(source)


def test_a_table_loses_its_constexpr_and_has_a_mutant_a_cell():
    source = "constexpr Row kRows[] = {{E::kA, E::kB}, {E::kB, E::kA}};"
    text, mutants = rewrite(source, "a.cc", 0)
    assert "constexpr" not in text and text.count("cell<") == len(mutants) == 4


def test_a_value_of_a_case_is_left_alone_and_what_it_does_is_not():
    text, mutants = rewrite("void f() { switch (a) { case kB: g(); break; } }", "a.cc", 0)
    assert "case kB:" in text and "(a)" in text
    assert [mutant.to for mutant in mutants] == ["left out"]


def test_known_by_what_it_says_not_by_where_it_stands():
    source = "int f() {\n  return 7;  // why\n}"
    _, here = rewrite(source, "a.cc", 0)
    _, there = rewrite("\n\n" + source.replace("why", "because"), "a.cc", 500)
    assert [m.key for m in here] == [m.key for m in there]
    assert here[0].line != there[0].line and there[0].number == 500
    assert here[0].key == ("a.cc", "f", "return ⟦7⟧;", "+ 1")


def listed(tmp_path, text):
    path = tmp_path / "survivors.yaml"
    path.write_text(text, encoding="utf-8")
    return survivors.load(path)


def test_survivors_have_reasons(tmp_path):
    _, mutants = rewrite("int f() { return 7; }", "a.cc", 0)
    reasons = listed(tmp_path, survivors.as_yaml(mutants, "nobody reads it"))
    assert reasons == {mutant.key: "nobody reads it" for mutant in mutants}
    assert not survivors.stale(reasons, mutants, {"a.cc"})
    assert survivors.stale(reasons, mutants[1:], {"a.cc"}) == [mutants[0].key]
    assert not survivors.stale(reasons, [], {"another.cc"})
    with pytest.raises(InputError, match="each entry has"):
        listed(tmp_path, survivors.as_yaml(mutants, " "))
    entry = survivors.as_yaml(mutants, "x").split("\n", 1)
    with pytest.raises(InputError, match="twice"):
        listed(tmp_path, entry[0] + "\n" + entry[1] + entry[1])


def test_fails_on_unlisted_survivors_and_on_listed_ones_that_are_found():
    _, (first, second) = rewrite("int f() { return 7; }", "a.cc", 0)
    alive, found = Verdict(False), Verdict(True, "Test.Case")

    def result(verdicts, reasons, part=frozenset()):
        return Result(verdicts, set(part), set(), reasons, [])

    assert result({first: found, second: alive}, {second.key: "why"}).passed()
    assert result({first: found, second: alive}, {}).unlisted() == [second]
    killed = result({first: found}, {first.key: "why"})
    assert killed.listed_but_killed() == [first] and not killed.passed()
    assert result({first: found}, {first.key: "why"}, {first.key}).passed()


def test_every_area_names_sources_and_none_twice():
    files = [file for area in targets.areas() for file in area.files]
    assert len(files) == len(set(files)) > 50
    assert targets.chosen(["torque_gate.cc"], targets.areas()) == {"drivers/gate/torque_gate.cc"}
    with pytest.raises(InputError, match="'tests' is not mutated"):
        targets.chosen(["tests"], targets.areas())


def test_batches_hold_one_program_and_grow():
    cases = [RecordedTest("one", str(i), 0.2, frozenset()) for i in range(8)]
    cases.append(RecordedTest("two", "last", 0.2, frozenset()))
    batches = _batches(cases)
    assert [case for batch in batches for case in batch] == cases
    assert len(batches[0]) < len(batches[1]) and batches[-1] == cases[-1:]
