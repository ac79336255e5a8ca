"""limber-send: requests to a running stack, accepted, or refused with a reason."""

import re
import subprocess
import sys

import pytest

from limber.lcmtypes.controller_status_t import controller_status_t as Status
from limber.live.way import in_words
from stack import BIN, ROOT


def limber_send(*entries: str, client: int | None = None) -> subprocess.CompletedProcess:
    """Through the command line; as another client, by the program itself."""
    command = [sys.executable, "-m", "limber", "send"]
    if client is not None:
        command = [str(BIN / "limber-send"), "--client", str(client)]
    return subprocess.run(
        [*command, *entries],
        cwd=ROOT / "tools",
        timeout=300,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )


def test_command_line(standing):
    stack = standing
    done = limber_send("mode: hold")
    assert done.returncode == 0, done.stderr
    stack.until(lambda: stack.mode == Status.MODE_HOLD, 10, "HOLD")
    wrong = limber_send("gains: {law: salisburry}")
    assert wrong.returncode == 2
    assert "did you mean 'salisbury'?" in wrong.stderr
    unfit = limber_send("gains: {law: admittance}")
    assert unfit.returncode == 2
    assert (
        "refused by the controller: request.LAW: admittance needs a contact source" in unfit.stderr
    )
    stranger = limber_send("mode: idle", client=5)
    assert stranger.returncode == 2
    assert "another client holds the lease" in stranger.stderr
    assert limber_send("mode: release").returncode == 0
    assert limber_send("mode: idle", client=5).returncode == 0
    stack.until(lambda: stack.mode == Status.MODE_IDLE, 10, "IDLE")


def test_nobody_there(tmp_path):
    done = limber_send("mode: hold")
    assert done.returncode == 2
    assert "no controller answers" in done.stderr


def test_one_line_an_entry(standing):
    """From standard input: each answered, and none of them ends it."""
    lines = ["gains: {damping_ratio: 0.8}", "mode: active", "gains: {damping: 3}", "mode: hold"]
    done = subprocess.run(
        [str(BIN / "limber-send")],
        input="\n".join(lines),
        capture_output=True,
        text=True,
        timeout=300,
    )
    answers = done.stdout.splitlines()
    assert [answer.split(":")[0] for answer in answers] == ["ok", "error", "error", "ok"]
    assert in_words("IDLE", "active") in answers[1]
    assert done.returncode == 2


@pytest.mark.usefixtures("standing")
def test_a_refusal_names_request_mode_and_way():
    """In the same words as the page and Python."""
    goal = "goal: {position_m: [0.3, 0, 0.3], quaternion_wxyz: [1, 0, 0, 0]}"
    for entry, wanted in (("mode: active", "active"), ("mode: acknowledge", "acknowledge")):
        assert in_words("IDLE", wanted) in limber_send(entry).stderr
    words = limber_send(goal).stderr
    assert words.rstrip().endswith("the way there: hold, active"), "and nothing else to do"


def test_in_a_fault_the_way_begins_with_acknowledge(standing):
    stack = standing
    limber_send("mode: hold")
    stack.until(lambda: stack.mode == Status.MODE_HOLD, 10, "HOLD")
    limber_send("fault: {joint: joint3, kind: silent, for_s: 0.3}")
    stack.until(lambda: stack.mode == Status.MODE_FAULT, 20, "FAULT")
    refused = limber_send("mode: active").stderr
    assert "request.MODE: active is not taken in FAULT" in refused
    assert "the way there: acknowledge, hold, active" in refused
    limber_send("mode: hold")
    wanted = re.compile(r"mode hold at \d+\.\d{3} s refused: request\.MODE: .*not taken in FAULT")
    stack.until(lambda: wanted.search(stack.log("controller")), 10, "the controller's log")
