"""`limber identify joints` with the real driver: a hand turns each joint of a simulated arm.

The simulator has one robot.yaml, the driver another: what is wrong in it has to be named.
"""

import json
import re
import shutil
import subprocess
import sys
import threading

import pytest

from hand import Hand
from limber.lcmtypes.controller_status_t import controller_status_t as Status
from limber.lcmtypes.joint_state_t import joint_state_t as State
from limber.lcmtypes.mode_request_t import mode_request_t as Request
from stack import ROOT
from test_terminal import ANSI, in_terminal

TASK = re.compile(r"^(joint\d), \d of 7 .* by ([\d.]+) rad .* (counter-clockwise|clockwise), seen")
# A driver without a simulator of its own is in real time.
SLOW = (("rate_hz: 1000", "rate_hz: 50"), ("timeout_s: 0.02", "timeout_s: 0.3"))
NAMES = [f"joint{i}" for i in range(1, 8)]


def variant(folder, *changes: tuple[str, str]) -> str:
    """openarm with lines of its robot.yaml changed, each in its first place."""
    shutil.copytree(ROOT / "robots/openarm", folder)
    path = folder / "robot.yaml"
    text = path.read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    path.write_text(text, encoding="utf-8")
    return str(folder)


@pytest.fixture
def weightless(stack, tmp_path):
    """The simulated arm without stand and weight, and a hand."""
    robot = variant(tmp_path / "arm", *SLOW, ("format:", "gravity_m_per_s2: [0, 0, 0]\nformat:"))
    stack.robot = robot
    stack.start("sim", "--no-stand", "--realtime")
    stack.until(lambda: stack.truth is not None, 20, "the simulator")
    return Hand(stack, robot)


def started(robot: str, *options: str) -> subprocess.Popen:
    return subprocess.Popen(
        [sys.executable, "-m", "limber", "identify", "joints", robot, "--no-sim", *options],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def led(hand: Hand, process: subprocess.Popen) -> tuple[int, str]:
    """Does what it is told; exit code and all that was printed."""
    end = threading.Timer(180, process.kill)
    end.start()
    printed = ""
    for line in process.stdout:
        printed += line
        if task := TASK.match(line):
            change = float(task[2]) + 0.06
            hand.turn(NAMES.index(task[1]), change if task[3] != "clockwise" else -change)
    end.cancel()
    return process.wait(20), printed


def checked(hand: Hand, folder, *changes: tuple[str, str]) -> tuple[int, str, dict]:
    """With the driver's own robot.yaml; exit code, text, and the rows by joint."""
    out = folder / "found.json"
    process = started(variant(folder / "believed", *SLOW, *changes), "--json", str(out))
    code, printed = led(hand, process)
    content = json.loads(out.read_text(encoding="utf-8"))
    assert content["passed"] == (code == 0), printed
    return code, printed, {row["joint"]: row for row in content["joints"]}


def verdicts(rows: dict) -> dict:
    return {name: row["verdict"] for name, row in rows.items() if row["verdict"] != "ok"}


def test_every_joint_right(weightless, tmp_path):
    code, printed, rows = checked(weightless, tmp_path)
    assert code == 0 and verdicts(rows) == {}, printed
    assert list(rows) == NAMES
    assert all(0.2 <= abs(row["moved"]) < 0.6 for row in rows.values()), printed
    assert "Every joint is its own motor's and turns the right way." in printed


def test_a_wrong_sign(weightless, tmp_path):
    """Of a joint without weight, which no watch finds."""
    code, printed, rows = checked(weightless, tmp_path, ("id: 5\n", "id: 5\n    sign: -1\n"))
    assert code == 1 and verdicts(rows) == {"joint5": "sign"}, printed
    lines = (tmp_path / "believed/robot.yaml").read_text(encoding="utf-8").splitlines()
    line = lines.index("    sign: -1") + 1
    assert f"joints.joint5.sign: 1 instead of -1 (robot.yaml:{line})" in printed
    assert "Wrong: joint5." in printed


def test_two_motors_exchanged(weightless, tmp_path):
    swap = [("id: 6\n    reply_id: 22", "id: 99\n    reply_id: 99")]
    swap += [("id: 5\n    reply_id: 21", "id: 6\n    reply_id: 22")]
    swap += [("id: 99\n    reply_id: 99", "id: 5\n    reply_id: 21")]
    code, printed, rows = checked(weightless, tmp_path, *swap)
    assert code == 1, printed
    assert verdicts(rows) == {"joint5": "exchanged", "joint6": "exchanged"}, printed
    assert rows["joint5"]["moved_joint"] == "joint6"
    written = {change["key"]: change["write"] for change in rows["joint5"]["changes"]}
    assert written == {"joints.joint5.id": "5", "joints.joint5.reply_id": "21"}
    assert "exchanged: joints.joint5.id (line " in printed and "and joints.joint6.id" in printed


def test_powered_arms_are_left_alone(stack):
    """Refused while the drives are on; ended at once when they are enabled meanwhile."""
    stack.start_all()
    stack.until(lambda: stack.mode == Status.MODE_IDLE, 20, "IDLE")
    process = started("openarm")
    assert "running already" in process.stdout.readline()
    assert "A controller runs, too" in process.stdout.readline()
    stack.bring_to(Status.MODE_HOLD)
    end = threading.Timer(60, process.kill)
    end.start()
    rest = process.stdout.read()
    end.cancel()
    assert process.wait(20) == 3, rest
    assert re.search(r"the drives have become (ENABLING|ON), not OFF: take your hands off", rest)
    assert stack.state.drive_state == State.DRIVE_ON
    refused = started("openarm")
    printed = refused.communicate(timeout=300)[0]
    assert refused.returncode == 3 and "the drives are ON, not OFF" in printed
    stack.request(Request.REQUEST_IDLE)


def test_another_arm_runs(stack):
    stack.start_all()
    stack.until(lambda: stack.mode == Status.MODE_IDLE, 20, "IDLE")
    wrong = started("panda")
    printed = wrong.communicate(timeout=300)[0]
    assert wrong.returncode == 2 and "the running arm is openarm" in printed


def test_in_a_terminal(tmp_path):
    """With a simulated arm of its own, which falls, and nobody's hand on it."""
    out = tmp_path / "found.json"
    answers = {"shoulder, 1 of 2": "s", "elbow, 2 of 2": "q"}
    code, written = in_terminal(
        "identify", "joints", "desktop2r", "--json", str(out), answers=answers
    )
    text = ANSI.sub("", written)
    assert code == 1, text[-3000:]
    assert "shoulder: skipped" in text and "stopped by you" in text
    rows = json.loads(out.read_text(encoding="utf-8"))["joints"]
    assert [row["verdict"] for row in rows] == ["skipped", "not checked"]
    assert "Not known: shoulder, elbow: these joints have not been tried." in text
