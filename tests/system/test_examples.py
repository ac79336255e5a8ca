"""Every program in examples/, as it is, from another folder, against a running simulated arm."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from limber.lcmtypes.controller_status_t import controller_status_t as Status
from stack import ROOT

EXAMPLES = ROOT / "examples"
LONGEST_LINES = 40

SHOWS = {
    "read": "openarm: idle, law cartesian_impedance",
    "move": "the goal was not reached",
    "soften": "800 N/m: ",
    "feel": "contact, ",
    "record_and_plot": "no message lost",
    "policy": "a circle in 6.",
}


@pytest.fixture
def openarm(stack):
    stack.start_all()
    stack.until(lambda: stack.mode == Status.MODE_IDLE, 20, "IDLE")
    return stack


def run(program: Path, folder: Path) -> str:
    done = subprocess.run(
        [sys.executable, program, folder],
        cwd=folder,
        env={**os.environ, "MPLBACKEND": "Agg"},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_all_are_here_and_short():
    programs = {path.stem: path.read_text(encoding="utf-8") for path in EXAMPLES.glob("*.py")}
    assert programs.keys() == SHOWS.keys()
    assert all(text.count("\n") < LONGEST_LINES for text in programs.values())


@pytest.mark.parametrize("name", SHOWS)
def test_example(name, openarm, tmp_path):
    assert SHOWS[name] in run(EXAMPLES / f"{name}.py", tmp_path)
    # An arm that was commanded is left held.
    mode = Status.MODE_IDLE if name == "read" else Status.MODE_HOLD
    openarm.until(lambda: openarm.mode == mode, 5, "the arm to be left")
    if name == "record_and_plot":
        assert (tmp_path / "push.png").read_bytes().startswith(b"\x89PNG")


def test_the_one_in_the_readme(openarm, tmp_path):
    """As it is printed there; the arm is left held."""
    code = re.search(
        r"^```python\n(.*?)^```", (ROOT / "README.md").read_text("utf-8"), re.M | re.S
    )[1]
    script = tmp_path / "readme.py"
    script.write_text(code, encoding="utf-8")
    assert len(run(script, tmp_path).split("[")) == 3, "position and error"
    openarm.until(lambda: openarm.mode == Status.MODE_HOLD, 5, "the arm to be left")


def test_the_one_of_the_policies(stack, tmp_path):
    """As it is printed there, in ten seconds: an arm with a hand goes round."""
    page = (ROOT / "docs" / "policies.md").read_text("utf-8")
    script = tmp_path / "policy.py"
    script.write_text(re.search(r"^```python\n(.*?)^```", page, re.M | re.S)[1], encoding="utf-8")
    stack.robot = "openarm_right"
    stack.start_all()
    stack.until(lambda: stack.mode == Status.MODE_IDLE, 20, "IDLE")
    taken = int(re.search(r"(\d+) taken, 0 late, 0 stale, 0 refused", run(script, tmp_path))[1])
    assert taken > 200
    stack.until(lambda: stack.mode == Status.MODE_HOLD, 5, "the arm to be left")


def test_stiffer_moves_less(openarm, tmp_path):
    lines = run(EXAMPLES / "soften.py", tmp_path).splitlines()
    moved = [float(line.split(":")[1].split("mm")[0]) for line in lines]
    assert moved == sorted(moved, reverse=True) and moved[0] > 2 * moved[2] > 0


def test_notebook(openarm, tmp_path):
    """Its code, cell by cell."""
    notebook = json.loads((EXAMPLES / "first_steps.ipynb").read_text(encoding="utf-8"))
    cells = ["".join(c["source"]) for c in notebook["cells"] if c["cell_type"] == "code"]
    assert not [c for c in notebook["cells"] if c.get("outputs")], "kept without outputs"
    script = tmp_path / "notebook.py"
    check = "assert np.ptp(curves[300]['p_BT'][:, 1]) > np.ptp(curves[800]['p_BT'][:, 1]) > 0"
    script.write_text("\n\n".join([*cells, check]), encoding="utf-8")
    run(script, tmp_path)
