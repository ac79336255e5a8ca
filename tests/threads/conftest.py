"""Programs that thread sanitizer watches, in the folder where the others find them."""

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
WATCHED = ("limber-driver", "limber-record")


def build() -> None:
    for command in (["cmake", "--preset", "tsan"], ["cmake", "--build", "--preset", "tsan"]):
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr


@pytest.fixture(scope="session")
def programs(tmp_path_factory) -> Path:
    """A folder with all of them, beside the library for Python."""
    build()
    prefix = tmp_path_factory.mktemp("prefix")
    os.symlink(ROOT / "build" / "dev" / "lib", prefix / "lib")
    folder = prefix / "bin"
    folder.mkdir()
    for plain in (ROOT / "build" / "dev" / "bin").iterdir():
        watched = ROOT / "build" / "tsan" / "bin" / plain.name
        os.symlink(watched if plain.name in WATCHED else plain, folder / plain.name)
    return folder


@pytest.fixture
def races(tmp_path, monkeypatch):
    """What thread sanitizer reported, once the processes have ended."""
    monkeypatch.setenv("TSAN_OPTIONS", f"log_path={tmp_path}/race")
    return lambda: [path.read_text(encoding="utf-8") for path in tmp_path.glob("race.*")]
