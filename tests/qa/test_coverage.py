"""Figures of coverage that may rise, but not fall."""

import yaml

from limber_qa import coverage


def counted(lines, branches):
    """A source as gcovr counts it: (covered, total)."""
    return {
        "filename": "drivers/gate/torque_gate.cc",
        "line_covered": lines[0], "line_total": lines[1],
        "branch_covered": branches[0], "branch_total": branches[1],
    }  # fmt: skip


def compared(source, before=None):
    known = (
        {}
        if before is None
        else {source["filename"]: dict(zip(("lines", "branches"), before, strict=True))}
    )
    return coverage.compared([source], known)[0]


def test_a_figure_that_falls_is_told():
    half = counted((5, 10), (10, 10))
    assert compared(half, (50.1, 100.0)).fell
    assert compared(half, (50.0, 100.0)) == compared(half, (50.0, 100.0))
    same = compared(half, (50.0, 100.0))
    assert not same.fell and not same.rose
    assert compared(counted((10, 10), (9, 10)), (100.0, 90.1)).fell


def test_a_figure_that_rises_is_told_unless_another_falls():
    assert compared(counted((6, 10), (10, 10)), (50.0, 100.0)).rose
    mixed = compared(counted((6, 10), (5, 10)), (50.0, 60.0))
    assert mixed.fell and not mixed.rose


def test_a_new_source_is_covered_in_full_or_fails():
    assert compared(counted((9, 10), (4, 4))).fell
    assert not compared(counted((10, 10), (0, 0))).fell


def test_figures_are_rounded_down():
    """1999 of 2000 is not all."""
    figure = compared(counted((1999, 2000), (2, 3)))
    assert (figure.lines, figure.branches) == (99.9, 66.6)


def test_what_is_written_is_read_again(tmp_path):
    path = tmp_path / "coverage.yaml"
    found = [compared(counted((9, 10), (4, 8)))]
    coverage.write(found, path)
    again = coverage.compared([counted((9, 10), (4, 8))], yaml.safe_load(path.read_text()))
    assert not again[0].fell and not again[0].rose
