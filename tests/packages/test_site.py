"""The pages as a site: all of them, whole, and without a network."""

import re
from pathlib import Path

import pytest

from limber.paths import ROOT
from limber_qa import site


@pytest.fixture(scope="session")
def pages(tmp_path_factory) -> Path:
    return site.build(tmp_path_factory.mktemp("site"))


def test_every_page_of_the_repository_is_in_it(pages):
    """But for what is no page of its own."""
    listed = {page for group in site.NAV.values() for page in group}
    folders = ("docs", "qa", "lecture", "robots", "scenarios", ".")
    there = {str(p.relative_to(ROOT)) for f in folders for p in (ROOT / f).glob("*.md")}
    assert listed == there
    assert len(list(pages.rglob("*.html"))) == len(listed) + 1, "and the page for a wrong address"


def test_nothing_is_loaded_from_elsewhere(pages):
    for page in pages.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        assert not re.search(r"<(script|img|iframe)[^>]* src=[\"']?(https?:)?//", text), page
        assert not re.search(r"<link[^>]*stylesheet[^>]*href=[\"']?https?:", text), page


def test_formulas_are_drawn_and_lists_stay_whole(pages):
    laws = (pages / "docs" / "control_laws.html").read_text(encoding="utf-8")
    assert laws.count("<math") > 40 and "$$" not in laws
    part = laws[laws.index('id="how-stiff-may-i-go"') :]
    first = part[part.index("<ol>") : part.index("</ol>")]
    assert first.count("<li>") == 7, "seven rules in one list"


def test_links_lead_somewhere(pages):
    """To files in the site; zensical has checked pages and their anchors."""
    for page in pages.rglob("*.html"):
        for target in re.findall(r"(?:href|src)=\"?([^\"#?> ]+)", page.read_text(encoding="utf-8")):
            if "://" not in target and not target.startswith(("mailto:", "data:", "/")):
                assert (page.parent / target).exists(), f"{page.relative_to(pages)}: {target}"
