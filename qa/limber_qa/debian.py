"""Debian packages, each suite's in a root file system of its own.

Libraries that limber is linked with have other versions in each suite (fmt, spdlog, yaml-cpp), so
one build does not serve both. What is installed for a build comes from the suite; the build itself
has no network, and LCM's generator, which Debian lacks, from a file.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import tomllib
from datetime import UTC, datetime
from email.utils import format_datetime
from pathlib import Path

from limber import __version__
from limber.errors import RunError
from limber.paths import ROOT, captured, completed

SUITES = {"bookworm": "12", "trixie": "13"}
PYTHON = {"bookworm": "3.11", "trixie": "3.13"}
PACKAGING = "packaging/debian"
FOR_THE_BUILD = ("lcm", "pyyaml")  # by pip, as in cmake/limber_dependencies.cmake
BUILD = """
set -e
cd /build/limber-*
apt-get build-dep -y -qq ./ >/dev/null
export PIP_NO_INDEX=1 PIP_FIND_LINKS=/build/wheels DEB_BUILD_OPTIONS=parallel=2
unshare -n dpkg-buildpackage -b -us -uc >/dev/null
mkdir /made && mv /build/*.deb /made
cd /made
"""
# Beside the packages: Debian 12's typer is too old, and that of Debian 13, pure Python, fits both.
# The wheel carries Debian 12's KDL, whose licence wants its sources to come with it.
BESIDE = {
    "bookworm": """
sed 's/^deb /deb-src /' /etc/apt/sources.list >/etc/apt/sources.list.d/sources.list
apt-get update -qq && apt-get source -qq --download-only orocos-kdl
""",
    "trixie": "apt-get download -qq python3-typer",
}


def last_commit_s() -> int:
    """When it was made: the time of all that is built of it."""
    return int(captured(["git", "log", "-1", "--format=%ct"], cwd=ROOT).stdout or 0)


def version(suite: str) -> str:
    """Of pyproject.toml; a newer Debian's sorts behind."""
    return f"{__version__}+deb{SUITES[suite]}"


def write_sources(folder: Path, suite: str) -> Path:
    """limber-VERSION below `folder`: the last commit, and debian/ as dpkg-buildpackage wants it."""
    sources = folder / f"limber-{__version__}"
    sources.mkdir(parents=True)
    archive = subprocess.run(["git", "archive", "HEAD"], cwd=ROOT, check=True, capture_output=True)
    subprocess.run(["tar", "-x", "-C", str(sources)], input=archive.stdout, check=True)
    (sources / PACKAGING).rename(sources / "debian")
    when = format_datetime(datetime.fromtimestamp(last_commit_s(), UTC))
    control = (sources / "debian" / "control").read_text(encoding="utf-8")
    (who,) = (line for line in control.splitlines() if line.startswith("Maintainer: "))
    (sources / "debian" / "changelog").write_text(
        f"limber ({version(suite)}) {suite}; urgency=medium\n\n  * Built for Debian "
        f"{SUITES[suite]}; what is new stands in CHANGELOG.md.\n\n"
        f" -- {who.removeprefix('Maintainer: ')}  {when}\n",
        encoding="utf-8",
    )
    return sources


def _wheels(folder: Path, suite: str) -> None:
    """What the build needs of pip's, as files."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    needed = [line for line in project["dependencies"] if line.startswith(FOR_THE_BUILD)]
    pip = [sys.executable, "-m", "pip", "download", "--quiet", "--only-binary=:all:", "--no-deps"]
    completed([*pip, f"--python-version={PYTHON[suite]}", "-d", str(folder), *needed])


def build(suite: str, out: Path) -> list[Path]:
    """All that Debian's tools make of it, debug files among it, and what lies BESIDE. As root."""
    if shutil.which("mmdebstrap") is None or os.geteuid() != 0:
        raise RunError(
            "Debian packages are built by root with mmdebstrap (sudo apt-get install mmdebstrap)"
        )
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "build"
        write_sources(folder, suite)
        _wheels(folder / "wheels", suite)
        (folder / "run").write_text(BUILD + BESIDE[suite], encoding="utf-8")
        made = Path(name) / "made"
        made.mkdir()
        hooks = (
            f"copy-in {folder} /",
            'chroot "$1" sh /build/run',
            f'cp "$1"/made/* {made}',
        )
        completed(
            [
                *("mmdebstrap", "--variant=buildd", "--include=debhelper,apt-utils"),
                *(f"--customize-hook={hook}" for hook in hooks),
                *(suite, "/dev/null"),
                *filter(None, [os.environ.get("LIMBER_DEBIAN_MIRROR")]),
            ]
        )
        found = sorted(made.iterdir())
        for path in found:
            shutil.copyfile(path, out / path.name)
    return [out / path.name for path in found]
