"""limber's packages in bare Debian 12 and 13: built, installed from files and used without a
network; the demo's table is the README's, and a log has the bytes of the tree's.
"""

import filecmp
import re
import shutil
from pathlib import Path

import pytest
from test_bare_systems import MIRROR, call, rows

from limber.paths import ROOT
from limber_qa import debian

WITH = "cmake,g++,libeigen3-dev,make,pkg-config"  # what compiles a law
INSTALL = "apt-get install -y -qq --no-install-recommends"


@pytest.fixture(scope="session")
def packages(tmp_path_factory) -> dict[str, list[Path]]:
    """Of each suite; Debian 12's with the typer of Debian 13."""
    if shutil.which("mmdebstrap") is None:
        pytest.skip("no mmdebstrap: sudo apt-get install mmdebstrap")
    found: dict[str, list[Path]] = {}
    for suite in debian.SUITES:
        made = debian.build(suite, tmp_path_factory.mktemp(suite))
        found[suite] = [path for path in made if re.match("(lib)?limber(0|-dev)?_", path.name)]
    found["bookworm"] += [path for path in made if "typer" in path.name]
    return found


@pytest.mark.timeout(3600)
@pytest.mark.parametrize("suite", debian.SUITES)
def test_the_packages_are_installed_and_used(suite, packages, tmp_path):
    debs = tmp_path / "debs"
    debs.mkdir()
    for path in packages[suite]:
        shutil.copy(path, debs)
    system = tmp_path / suite
    hooks = [f"copy-in {debs} /", f'chroot "$1" sh -c "{INSTALL} /debs/*.deb"']
    hooks += [f"copy-in {Path(__file__).with_name('in-bare-debian')} /"]
    hooks = [f"--customize-hook={hook}" for hook in hooks]
    more = filter(None, [MIRROR])
    call("mmdebstrap", "--variant=minbase", f"--include={WITH}", *hooks, suite, system, *more)
    inside = ["unshare", "-m", "-p", "-f", "-n", "chroot", str(system)]
    shown = call(*inside, "/in-bare-debian", ROOT / "robots")
    assert rows(shown) == rows((ROOT / "README.md").read_text(encoding="utf-8"))
    assert len(rows(shown)) == 4
    log = tmp_path / "run.lcmlog"
    lab = ROOT / "build" / "dev" / "bin" / "limber-lab"
    robots = f"LIMBER_ROBOTS={ROOT / 'robots'}"
    call("env", robots, lab, ROOT / "scenarios/quick.yaml", "--log", log)
    assert filecmp.cmp(log, system / "root" / "quick" / "run.lcmlog", shallow=False)
