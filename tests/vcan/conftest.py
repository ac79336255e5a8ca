"""Tests with other people's tools on the kernel's CAN; run-in-vcan starts pytest in the lab."""

import shutil
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "system"))

from stack import Stack  # noqa: E402


@pytest.fixture
def stack(monkeypatch):
    # Below the tree: the lab's own /tmp is lost with it.
    folder = HERE.parents[1] / "build" / "dev" / "vcan-tests"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    monkeypatch.setenv("LIMBER_BLACK_BOXES", str(folder / "black_boxes"))
    running = Stack(folder, pace="--realtime")
    try:
        yield running
    finally:
        running.close()
        shutil.rmtree(folder, ignore_errors=True)
