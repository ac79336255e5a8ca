"""The wheel in bare Debian 12 and 13, from files alone, without a network: the demo's table is the
README's, and a log has the bytes of the tree's.
"""

import filecmp
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from limber.paths import ROOT
from limber_qa import release

SUITES = {"bookworm": "3.11", "trixie": "3.13"}  # their Python
MIRROR = os.environ.get("LIMBER_DEBIAN_MIRROR")  # as for tests/vcan/get-uml; else mmdebstrap's
PLATFORMS = (
    "manylinux_2_35",
    "manylinux_2_28",
    "manylinux_2_27",
    "manylinux_2_17",
    "manylinux2014",
)
ROW = re.compile(r"^\+[xyz] +(?:on|off) .*", re.MULTILINE)


def call(*words: object) -> str:
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{words}\n{done.stdout}{done.stderr}"
    return done.stdout


def download(wheel: Path, folder: Path, python: str, machine: str) -> None:
    """It and all that it needs."""
    platforms = [f"--platform={name}_{machine}" for name in PLATFORMS]
    pip = [sys.executable, "-m", "pip", "download", "--quiet", "--only-binary=:all:", *platforms]
    call(*pip, f"--python-version={python}", "-d", folder, wheel)


def rows(text: str) -> list[list[str]]:
    return [row.split() for row in ROW.findall(text)]


@pytest.fixture(scope="session")
def wheel(tmp_path_factory) -> Path:
    return release.build_wheel(tmp_path_factory.mktemp("wheel"))  # by pip alone, as a release


@pytest.mark.timeout(1800)
@pytest.mark.parametrize("suite", SUITES)
def test_the_demo_runs(suite, wheel, tmp_path):
    if shutil.which("mmdebstrap") is None:
        pytest.skip("no mmdebstrap: sudo apt-get install mmdebstrap")
    system = tmp_path / suite
    call(
        "mmdebstrap",
        "--variant=minbase",
        "--include=python3-venv",
        suite,
        system,
        *filter(None, [MIRROR]),
    )
    wheels = system / "wheels"
    download(wheel, wheels, SUITES[suite], "x86_64")
    shutil.copy(Path(__file__).with_name("in-bare-system"), system)
    inside = ["unshare", "-m", "-p", "-f", "-n", "chroot", str(system)]
    shown = call(*inside, "/in-bare-system", "/wheels", ROOT / "robots")
    assert rows(shown) == rows((ROOT / "README.md").read_text(encoding="utf-8"))
    assert len(rows(shown)) == 4
    log = tmp_path / "run.lcmlog"
    lab = ROOT / "build" / "dev" / "bin" / "limber-lab"
    installed = system / "root" / "quick"
    call(
        "env", f"LIMBER_ROBOTS={ROOT / 'robots'}", lab, ROOT / "scenarios/quick.yaml", "--log", log
    )
    assert filecmp.cmp(log, installed / "run.lcmlog", shallow=False)
