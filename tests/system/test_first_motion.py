"""docs/first_motion.md and docs/own_arm.md, followed: each of their commands, in order."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from stack import ROOT

ENVIRONMENT = {**os.environ, "PATH": f"{ROOT / '.venv' / 'bin'}:{os.environ['PATH']}"}
BLOCK = re.compile(r"^```\n(.*?)^```", re.DOTALL | re.MULTILINE)


def commands(page: str, number: int) -> list[str]:
    """Of a block of a page, counted from 1, without comments."""
    text = BLOCK.findall((ROOT / "docs" / page).read_text(encoding="utf-8"))[number - 1]
    return [re.split(r"\s{2,}#", line)[0] for line in text.splitlines()]


def follow(line: str, folder: Path) -> subprocess.CompletedProcess:
    """As typed in a fresh clone, whose `out` is the test's own folder."""
    command = ["bash", "-c", line]
    done = subprocess.run(
        command, cwd=folder, capture_output=True, text=True, timeout=300, env=ENVIRONMENT
    )
    assert done.returncode == 0, f"{line}\n{done.stdout}{done.stderr}"
    return done


@pytest.fixture
def clone(tmp_path):
    for name in ("scenarios", "robots"):
        (tmp_path / name).symlink_to(ROOT / name)
    (tmp_path / "out").mkdir()
    return tmp_path


def stiffness(text: str, axis: str) -> float:
    return float(re.search(rf"stiffness \{axis} +([\d.]+) N/m", text)[1])


def test_a_stiffness_is_asked_for_measured_and_changed(clone):
    (first,) = commands("first_motion.md", 1)
    assert stiffness(follow(first, clone).stdout, "+y") == pytest.approx(500, rel=0.02)
    *_, last = [follow(line, clone) for line in commands("first_motion.md", 2)]
    assert stiffness(last.stdout, "+y") == pytest.approx(250, rel=0.02)
    assert stiffness(last.stdout, "+x") == pytest.approx(500, rel=0.02)
    follow("limber plot out/push", clone)
    assert "push for" in follow("limber log events out/push", clone).stdout


def test_a_running_arm_is_softened_pushed_and_moved(clone):
    (run,) = commands("first_motion.md", 3)
    line = f"{run} --out out/ready"
    running = subprocess.Popen(
        ["bash", "-c", f"exec {line}"],
        cwd=clone,
        stdout=subprocess.PIPE,
        text=True,
        env=ENVIRONMENT,
    )
    try:
        follow("limber watch --once", clone)
        watched, *sent = commands("first_motion.md", 4)
        assert "openarm" in follow(watched, clone).stdout
        for command in sent:
            follow(command, clone)
        (beyond,) = commands("first_motion.md", 5)
        done = follow(beyond, clone)
        assert "beyond" in done.stdout + done.stderr
    finally:
        running.send_signal(2)
        told = running.communicate(timeout=300)[0]
    assert "stopped" in told and running.returncode == 0, told


def test_an_arm_of_ones_own_is_described_and_runs(clone):
    new, check, lab = commands("own_arm.md", 1)
    shutil.copy(ROOT / "robots" / "openarm" / "robot.urdf", clone / "my_arm.urdf")
    new = new.replace("base_link", "world").replace("tool0", "link8")
    for line in (new, check, f"{lab} --out out/first"):
        follow(line, clone)
