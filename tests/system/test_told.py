"""What is wrong with drives reaches the terminal of whoever started the run, once."""

import shutil
import subprocess

from stack import ROOT

LIMBER = str(ROOT / ".venv/bin/limber")


def run_beside(folder, robot) -> str:
    """Three seconds with `robot`, whose drives are simulated by somebody else."""
    scenario = folder / "scenario.yaml"
    scenario.write_text(
        f"format: limber-scenario/1\nrobot: {robot}\nmode: realtime\nduration_s: 3\n"
        "timeline:\n  - {at_s: 0.3, mode: hold}\n",
        encoding="utf-8",
    )
    command = [LIMBER, "run", str(scenario), "--no-sim", "--out", str(folder / "out")]
    return subprocess.run(
        command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=300, check=False
    ).stdout


def changed(folder, old: str, new: str):
    """openarm with one line of its robot.yaml changed, first place only."""
    robot = folder / "arm"
    shutil.copytree(ROOT / "robots/openarm", robot)
    text = (robot / "robot.yaml").read_text(encoding="utf-8")
    assert old in text
    (robot / "robot.yaml").write_text(text.replace(old, new, 1), encoding="utf-8")
    return robot


def test_a_drives_wrong_setting(stack, tmp_path):
    stack.start("sim")
    said = run_beside(tmp_path, changed(tmp_path, "position_rad: 12.5", "position_rad: 12.6"))
    line = "joint1 (id 0x1): register 21 is 12.5, expected 12.6"
    assert said.count(f"\n{line}\n") == 1, "and once more in the words of the fault"
    assert said.index(line) < said.index("CONFIGURATION")  # of the table at the end


def test_a_motor_that_does_not_answer(stack, tmp_path):
    """Without an arm: within two seconds, while the waiting goes on."""
    driver = stack.start("driver", "--patience", "3")
    driver.wait(30)
    log = stack.log("driver")
    assert "warning: no answer yet from joint1 (id 0x1 on virtual:openarm)" in log
    assert "check power, bit rate, termination and ids; still waiting" in log
    assert log.index("no answer yet") < log.index("no answer for 3 s")
