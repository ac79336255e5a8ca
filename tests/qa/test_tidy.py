"""Which sources `limber dev tidy` reads."""

import pytest

from limber.errors import RunError
from limber_qa import tidy


def test_named_sources_all_or_those_that_changed(monkeypatch):
    changed = ["README.md", "sim/joints/spring.cc", "sim/joints/spring.h"]
    monkeypatch.setattr(tidy, "changed", lambda: changed)
    assert tidy.sources([], False) == ["sim/joints/spring.cc"]
    assert tidy.sources(["sim/joints/friction.cc"], False) == ["sim/joints/friction.cc"]
    assert len(tidy.sources([], True)) > 300


def test_what_is_no_source_is_named():
    with pytest.raises(RunError, match=r"sim/joints/spring\.h: no C\+\+ source"):
        tidy.sources(["sim/joints/spring.h"], False)
