"""Environments for other people's packages, with a Python that those can have."""

import subprocess
import sys
from pathlib import Path


def make_environment(folder: Path, version: str) -> bool:
    """In `folder`, with Python `version` of this machine or of uv; False if neither has it."""
    this = sys.version.startswith(f"{version}.")
    python = sys.executable if this else f"python{version}"
    if _runs([python, "--version"]):
        return _runs([python, "-m", "venv", folder])
    return _runs(["uv", "venv", "--seed", "--python", version, folder])


def _runs(command: list) -> bool:
    """A launcher of that name may be there without its Python."""
    try:
        return subprocess.run(command, capture_output=True).returncode == 0
    except OSError:
        return False
