"""The steps of docs/tutorial_own_law.md, carried out in a copy of the tree that is thrown away.

The copy is an overlay on the tree in a mount namespace, so that only what a step changes is built.
"""

import os
import shlex
import subprocess
from pathlib import Path

import pytest

import document
from limber.paths import ROOT

OUTPUTS = ("output.txt", "errors.txt", "done")
OVERLAY = f"""
set -e
mount -t tmpfs tmpfs "$1"
mkdir "$1/upper" "$1/work"
cd {shlex.quote(str(ROOT))}
mount -t overlay overlay -o "lowerdir=$PWD,upperdir=$1/upper,workdir=$1/work" "$PWD"
cd "$PWD"
"""


def in_overlay(script: str, folder: Path) -> subprocess.CompletedProcess:
    flags = "-m" if os.geteuid() == 0 else "-rm"
    mount_point = folder / "overlay"
    mount_point.mkdir(exist_ok=True)
    return subprocess.run(
        ["unshare", flags, "bash", "-c", OVERLAY + script, "bash", str(mount_point)],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )


def test_every_step_does_what_the_text_says(tmp_path):
    if in_overlay("", tmp_path).returncode != 0:
        pytest.skip("this machine permits no overlay in a mount namespace")
    steps = document.read(ROOT / "docs" / "tutorial_own_law.md")
    script = []
    for number, step in enumerate(steps):
        folder = tmp_path / str(number)
        folder.mkdir()
        if isinstance(step, document.Edit):
            step.apply(ROOT, folder)
            script.append(f"cp -r {folder}/. .")
        else:
            output, errors, done = (folder / name for name in OUTPUTS)
            script.append(f"( {step.text} ) >{output} 2>{errors} && touch {done} || exit")
    done = in_overlay("\n".join(script), tmp_path)
    commands = {i: step for i, step in enumerate(steps) if isinstance(step, document.Command)}
    assert len(commands) > 3 and len(steps) - len(commands) > 4, "blocks are not recognised"
    for number, command in commands.items():
        output, errors, code = (tmp_path / str(number) / name for name in OUTPUTS)
        text = f"$ {command.text}\n{output.read_text()}{errors.read_text()}{done.stderr}"
        assert code.exists(), f"failed: {text}"
        difference = document.difference(command.expected, output.read_text())
        assert not difference, f"{difference}\n{text}"


def test_a_wrong_number_is_found_and_times_do_not_count():
    expected = ["moved  0.0248 m   1 %  ok", "2 tests ran. (28 ms total)"]
    assert not document.difference(
        expected, "moved 0.02480000001 m 1 % ok\n2 tests ran. (3 ms total)"
    )
    assert "0.0249" in document.difference(expected, "moved 0.0249 m 1 % ok\n2 tests ran.")
    assert "words" in document.difference(expected, "moved 0.0248 m 1 % ok")
