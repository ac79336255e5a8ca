"""Runs limber-eval as a user would."""

import subprocess
from pathlib import Path

import numpy as np

from limber.paths import program

DATA = Path(__file__).parent / "data"
PLANAR = {
    "urdf": str(DATA / "planar2r.urdf"),
    "base": "base",
    "tip": "tip",
    "gravity": [0, -9.81, 0],
}
SEVEN = {
    "urdf": str(DATA / "seven.urdf"),
    "base": "ground",
    "tip": "tool",
    "gravity": [1.5, -2.0, -9.4],
}


def plain(value):
    """Arrays as lists, for JSON."""
    if isinstance(value, dict):
        return {key: plain(part) for key, part in value.items()}
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value


def run(text: str, *arguments: str) -> subprocess.CompletedProcess:
    return subprocess.run(
        [str(program("limber-eval")), *arguments],
        input=text,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
