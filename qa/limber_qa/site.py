"""The pages as a site that works without a network: `limber dev site`.

The Markdown stays as it is on a page of a repository. Formulas become MathML, which browsers draw
by themselves; files that pages link to lie beside them.
"""

import re
import shutil
import sys
import tempfile
from pathlib import Path

import yaml

from limber.paths import ROOT, completed, output_folder

NAV: dict[str, list[str]] = {
    "Start": [
        *(
            "README.md",
            "docs/first_motion.md",
            "docs/own_arm.md",
            "docs/first_hour.md",
            "docs/policies.md",
        ),
        *("docs/client.md", "docs/monitor.md", "docs/logs.md", "docs/troubleshooting.md"),
        "docs/safety.md",
    ],
    "Look up": [
        *("docs/control_laws.md", "docs/tutorial_own_law.md", "scenarios/README.md"),
        *("robots/README.md", "docs/joints.md", "docs/identification.md", "docs/drives_cia402.md"),
        "CHANGELOG.md",
    ],
    "Understand": [
        *("docs/architecture.md", "docs/real_time.md", "docs/bus.md"),
        *("docs/adding.md", "CONTRIBUTING.md"),
    ],
    "What proves it": [
        *("qa/README.md", "qa/fault_matrix.md", "qa/watches.md", "qa/performance.md"),
        "qa/check_trace.md",
    ],
    "The lecture": ["lecture/README.md", "lecture/eval.md"],
}
CODE = re.compile(r"(^```.*?^```$|`[^`\n]+`)", re.DOTALL | re.MULTILINE)
FORMULA = re.compile(r"\$\$(.+?)\$\$|\$([^$\n]+?)\$", re.DOTALL)
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^()\s]+)\)")
CONFIG = {
    "site_name": "limber",
    "docs_dir": "pages",
    "site_dir": "site",
    "use_directory_urls": False,  # opens from a disk, too
    "theme": {"name": "material", "font": False, "language": "en"},
    "markdown_extensions": [
        "tables",
        "md_in_html",
        "pymdownx.superfences",
        {"toc": {"permalink": True, "slugify": "!slug"}},
    ],
}
SLUGS = "!!python/object/apply:pymdownx.slugs.slugify {kwds: {case: lower}}"  # as GitHub's


def build(out: Path) -> Path:
    """The folder with index.html. Raises RunError for a dead link, or one to a dead anchor."""
    folder = output_folder(out)
    with tempfile.TemporaryDirectory() as name:
        stage = Path(name)
        for page in (page for pages in NAV.values() for page in pages):
            write_page(page, stage / "pages")
        config = {**CONFIG, "nav": [{title: pages} for title, pages in NAV.items()]}
        text = yaml.safe_dump(config, sort_keys=False).replace("'!slug'", SLUGS)
        (stage / "mkdocs.yml").write_text(text, encoding="utf-8")
        command = [str(Path(sys.executable).with_name("zensical")), "build", "--strict"]
        completed(command, cwd=stage)
        shutil.copytree(stage / "site", folder, dirs_exist_ok=True)
    return folder


def write_page(page: str, to: Path) -> None:
    """The page and the files it links to, at their places below `to`."""
    target = to / page
    target.parent.mkdir(parents=True, exist_ok=True)
    parts = CODE.split((ROOT / page).read_text(encoding="utf-8"))
    parts[::2] = [_prose(part, page, to) for part in parts[::2]]
    target.write_text("".join(parts), encoding="utf-8")


def _prose(text: str, page: str, to: Path) -> str:
    return FORMULA.sub(_mathml, LINK.sub(lambda link: _link(link, page, to), text))


def _link(link: re.Match[str], page: str, to: Path) -> str:
    """A folder has no page: its name stays as text."""
    place = link[3].partition("#")[0]
    source = (ROOT / page).parent / place
    if "://" in place or not place or source.suffix == ".md":
        return link[0]
    if source.is_dir():
        return link[2]
    copy = to / source.resolve().relative_to(ROOT)
    copy.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(source, copy)
    return link[0]


def _mathml(formula: re.Match[str]) -> str:
    from latex2mathml.converter import convert

    if formula[1] is not None:
        return f"\n\n{convert(formula[1], display='block')}\n\n"
    # At the beginning of a line <math> would end the paragraph.
    return f"<span>{convert(formula[2])}</span>"
