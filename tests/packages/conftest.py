"""The wheel as a user gets it, in an environment of its own, far from the tree."""

import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from limber.paths import ROOT
from limber_qa import release


@dataclass(frozen=True)
class Installed:
    """`bin`: of the Python environment; `package`: the folder `limber` in it."""

    bin: Path
    package: Path
    cwd: Path

    def call(self, *words: str, **more: str) -> subprocess.CompletedProcess[str]:
        """As a user's terminal would, in an empty folder."""
        known = {key: os.environ[key] for key in ("HOME", "LANG") if key in os.environ}
        environment = {**known, "PATH": f"{self.bin}:/usr/bin:/bin:/usr/sbin:/sbin", **more}
        return subprocess.run(
            words,
            cwd=self.cwd,
            env=environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=240,
            check=False,
        )


@pytest.fixture(scope="session")
def wheel(tmp_path_factory) -> Path:
    return release.build_wheel(tmp_path_factory.mktemp("wheel"), ROOT / "build" / "dev")


@pytest.fixture(scope="session")
def installed(wheel, tmp_path_factory) -> Installed:
    folder = tmp_path_factory.mktemp("installed")
    subprocess.run([sys.executable, "-m", "venv", str(folder / "venv")], check=True)
    python = folder / "venv" / "bin" / "python"
    pip = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    subprocess.run([*pip, str(wheel)], check=True)
    (package,) = (folder / "venv" / "lib").glob("python3*/site-packages/limber")
    (folder / "cwd").mkdir()
    return Installed(python.parent, package, folder / "cwd")
