"""What is named where a Debian package brought limber."""

import shutil
import sys
import sysconfig
from pathlib import Path

import pytest

from limber import paths
from limber.paths import captured

SHOW = (
    "from limber import paths; print(paths.PREFIX, paths.SHARE, paths.programs_folder(), "
    "paths.private_library('x.so'), paths.CMAKE, paths.REPAIR, sep='\\n')"
)


def test_where_things_are(tmp_path):
    """The package's folder at its place below a /usr."""
    modules = tmp_path / "usr" / "lib" / "python3" / "dist-packages"
    shutil.copytree(paths.PACKAGE, modules / "limber", ignore=shutil.ignore_patterns("__pycache__"))
    done = captured(
        [
            sys.executable,
            "-I",
            "-S",
            "-c",
            f"import sys; sys.path.insert(0, {str(modules)!r}); {SHOW}",
        ]
    )
    assert done.returncode == 0, done.stderr
    usr = tmp_path / "usr"
    *found, repair = done.stdout.splitlines()
    assert [Path(line) for line in found] == [
        usr,
        usr / "share" / "limber",
        usr / "bin",
        usr / "lib" / "limber" / "x.so",
        usr / "lib" / str(sysconfig.get_config_var("MULTIARCH")) / "cmake" / "limber",
    ]
    assert repair == "sudo apt-get install --reinstall limber liblimber0"


@pytest.fixture
def from_debian(monkeypatch):
    monkeypatch.setattr(paths, "FROM_DEBIAN", True)


def test_what_debian_has_comes_from_debian(from_debian):
    assert paths.command_for("scipy") == "sudo apt-get install python3-scipy"


def test_what_debian_lacks_goes_into_an_environment_of_ones_own(from_debian, monkeypatch):
    monkeypatch.setattr(sys, "base_prefix", sys.prefix)
    told = paths.command_for("viser")
    assert told is not None
    assert " && python3 -m venv --system-site-packages ~/limber-python && " in told
    assert "~/limber-python/bin/pip install 'viser>=1.1,<1.2'; " in told
    monkeypatch.setattr(sys, "base_prefix", "/usr")  # already there
    assert paths.command_for("viser") == f"{sys.executable} -m pip install 'viser>=1.1,<1.2'"
    assert paths.command_for("numpy") is None
