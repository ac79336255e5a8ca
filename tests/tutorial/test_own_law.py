"""The steps of docs/tutorial_own_law.md, carried out in an empty folder, away from the tree."""

import os
import subprocess
import sys
from pathlib import Path

import document
from limber.paths import ROOT


def carried_out(step: document.Command, folder: Path) -> str:
    """What it prints."""
    path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    done = subprocess.run(
        ["bash", "-c", step.text],
        cwd=folder,
        env={**os.environ, "PATH": path},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, f"$ {step.text}\n{done.stdout}{done.stderr}"
    return done.stdout


def test_every_step_does_what_the_text_says(tmp_path):
    steps = document.read(ROOT / "docs" / "tutorial_own_law.md")
    commands = [step for step in steps if isinstance(step, document.Command)]
    assert len(commands) > 3 and len(steps) - len(commands) > 1, "blocks are not recognised"
    for step in steps:
        if isinstance(step, document.Edit):
            step.apply(tmp_path, tmp_path)
            continue
        printed = carried_out(step, tmp_path)
        difference = document.difference(step.expected, printed)
        assert not difference, f"{difference}\n$ {step.text}\n{printed}"


def test_a_wrong_number_is_found_and_times_do_not_count():
    expected = ["moved  0.0248 m   1 %  ok", "2 tests ran. (28 ms total)"]
    assert not document.difference(
        expected, "moved 0.02480000001 m 1 % ok\n2 tests ran. (3 ms total)"
    )
    assert "0.0249" in document.difference(expected, "moved 0.0249 m 1 % ok\n2 tests ran.")
    assert "words" in document.difference(expected, "moved 0.0248 m 1 % ok")
    assert not document.difference(["moved  0.0248 m", "..."], "moved 0.0248 m\nand more")
    assert document.difference(["moved  0.0247 m", "..."], "moved 0.0248 m\nand more")
