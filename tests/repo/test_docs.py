"""Links in the docs lead somewhere, and words are spelled as others spell them."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
LINK = re.compile(r"(?<!!)\[[^\]]*\]\(([^)\s]+)\)|!\[[^\]]*\]\(([^)\s]+)\)")
CODE = re.compile(r"```.*?```|`[^`\n]*`", re.DOTALL)


def pages() -> list[Path]:
    tracked = subprocess.run(
        ["git", "ls-files", "*.md"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    return [ROOT / name for name in tracked.stdout.split()]


def anchors(page: Path) -> set[str]:
    """Of the headings, as GitHub makes them."""
    found = set()
    for line in re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.S).split("\n"):
        if line.startswith("#"):
            words = line.lstrip("#").strip().lower().replace("`", "")
            words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", words)
            found.add(re.sub(r"[^\w\- ]", "", words).replace(" ", "-"))
    return found


def broken_links(page: Path) -> list[str]:
    text = CODE.sub("", page.read_text(encoding="utf-8"))
    broken = []
    for match in LINK.finditer(text):
        target = match[1] or match[2]
        if target.startswith(("http://", "https://", "mailto:")):
            continue
        name, _, anchor = target.partition("#")
        file = (page.parent / name).resolve() if name else page
        missing = not file.exists()
        lost = bool(anchor) and not missing and anchor not in anchors(file)
        if missing or lost:
            broken.append(f"{page.relative_to(ROOT)}: {target}")
    return broken


def test_every_link_leads_somewhere():
    assert pages()
    broken = [line for page in pages() for line in broken_links(page)]
    assert not broken, "\n".join(broken)


def long_lines(page: Path) -> list[str]:
    """Of what is written by hand and can be broken: no tables, pictures, blocks and signatures."""
    found, block = [], False
    for number, line in enumerate(page.read_text(encoding="utf-8").split("\n"), 1):
        block ^= line.lstrip().startswith("```")
        if len(line) > 120 and not block and not line.startswith(("|", "![", "**`")):
            found.append(f"{page.relative_to(ROOT)}:{number}: {len(line)} characters")
    return found


def test_no_line_is_longer_than_120_characters():
    found = [line for page in pages() for line in long_lines(page)]
    assert not found, "\n".join(found)


def test_a_long_line_is_found(tmp_path, monkeypatch):
    monkeypatch.setattr(sys.modules[__name__], "ROOT", tmp_path)
    page = tmp_path / "a.md"
    page.write_text("a" * 120 + "\n```\n" + "b" * 121 + "\n```\n" + "c" * 121 + "\n| " + "d" * 121)
    assert long_lines(page) == ["a.md:5: 121 characters"]


def test_a_broken_link_is_found(tmp_path, monkeypatch):
    monkeypatch.setattr(sys.modules[__name__], "ROOT", tmp_path)
    page = tmp_path / "a.md"
    page.write_text("# One thing\n[x](#one-thing) [y](b.md) [z](#two) `[c](no.md)`\n")
    assert broken_links(page) == ["a.md: b.md", "a.md: #two"]


def test_every_page_of_the_docs_can_be_reached_from_the_readme():
    reached, waiting = set(), [ROOT / "README.md"]
    while waiting:
        page = waiting.pop()
        if page in reached or not page.is_file():
            continue
        reached.add(page)
        for match in LINK.finditer(CODE.sub("", page.read_text(encoding="utf-8"))):
            name = (match[1] or "").partition("#")[0]
            if name.endswith(".md") and "://" not in name:
                waiting.append((page.parent / name).resolve())
    missing = {page for page in (ROOT / "docs").glob("*.md")} - reached
    assert not missing


def test_spelling():
    """codespell knows common misspellings; words that are meant stand in pyproject.toml."""
    codespell = pytest.importorskip("codespell_lib", reason="comes with ./limber")
    assert codespell
    names = [str(page) for page in pages()]
    done = subprocess.run(
        [sys.executable, "-m", "codespell_lib", "--toml", str(ROOT / "pyproject.toml"), *names],
        capture_output=True,
        text=True,
        cwd=ROOT,
    )
    assert done.returncode == 0, done.stdout + done.stderr
