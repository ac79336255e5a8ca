"""A drive's error in the result of a run: as the driver's log has it."""

import json
import subprocess
import sys

import pytest

from limber.measure.faults import Fault
from limber.problems import groups
from limber.run.drive_words import with_words

ERROR = groups()["driver"].problems["DRIVE_ERROR"]
CHANGED = "register 10 is 2, expected 1: changed past the bus; end what else writes to it"


def line(joint: str, words: str) -> str:
    return (
        f"12:00:00.123 limber-driver: warning: drives: fallback: {ERROR.code}: {ERROR.what} "
        f"({joint}): {words}; {ERROR.remedy}; see docs/troubleshooting.md\n"
    )


def fault(joint: str, problem=ERROR) -> Fault:
    return Fault(problem, 1.0, joint, "the drive's code is 0x1", "", (), 2.0)


@pytest.mark.parametrize("name", ["limber-driver.log", "limber-lab.log"])
def test_the_changed_setting_is_told(tmp_path, name):
    (tmp_path / name).write_text("drives: on\n" + line("elbow", CHANGED))
    (told,) = with_words([fault("elbow")], tmp_path)
    assert told.title == f"driver.DRIVE_ERROR at 1.000 s, elbow: {CHANGED}"


def test_each_error_of_a_joint_has_its_own_words(tmp_path):
    log = line("elbow", CHANGED) + line("wrist", "error A: over-current") + line("elbow", "error 9")
    (tmp_path / "limber-driver.log").write_text(log)
    told = with_words([fault("elbow"), fault("wrist"), fault("elbow")], tmp_path)
    assert [one.measured for one in told] == [CHANGED, "error A: over-current", "error 9"]


def test_what_the_log_does_not_have_stays(tmp_path):
    faults = [fault("elbow"), fault("elbow", groups()["driver"].problems["BUS"])]
    assert with_words(list(faults), tmp_path) == faults, "no log"
    (tmp_path / "limber-driver.log").write_text(2 * line("elbow", CHANGED) + line("wrist", "x"))
    assert with_words(list(faults), tmp_path) == faults, "which of the two?"


LOST = groups()["driver"].problems["REPLY_LOST"]


def test_a_process_that_stood_still_is_named_before_any_cable(tmp_path):
    """The longest pause of each, whoever of them wrote it; a fault that pauses do not make is left
    as it is.
    """
    (tmp_path / "limber-sim.log").write_text(
        "12:00:00.1 limber-sim: warning: limber-sim stood still for 75 ms: this machine was busy\n"
        "12:00:00.9 limber-sim: warning: limber-sim stood still for 480 ms: this machine was busy\n"
    )
    (tmp_path / "limber-driver.log").write_text(
        f"limber-driver: warning: drives: fallback: {LOST.code}: {LOST.what}: "
        "all drives, joint1 (id 0x1) to joint7 (id 0x7): no reply for 3 cycles; "
        f"{LOST.remedy}; see docs\n"
    )
    lost, error = with_words([fault("", LOST), fault("elbow")], tmp_path)
    assert lost.title == (
        "driver.REPLY_LOST at 1.000 s: limber-sim stood still for 480 ms; all drives, "
        "joint1 (id 0x1) to joint7 (id 0x7): no reply for 3 cycles"
    )
    assert error.measured == "the drive's code is 0x1"


def test_an_unanswered_register_is_quoted(tmp_path):
    configuration = groups()["driver"].problems["CONFIGURATION"]
    assert "other settings" not in configuration.what
    words = "joint7 (id 0x7): register 2 not answered"
    (tmp_path / "limber-driver.log").write_text(
        f"limber-driver: warning: drives: fault: {configuration.code}: {configuration.what} "
        f"(joint7): {words}; {configuration.remedy}; see docs/troubleshooting.md\n"
    )
    (told,) = with_words([fault("joint7", configuration)], tmp_path)
    assert told.measured == words
    assert "load of this machine" in told.problem.remedy


def test_the_summary_of_a_run_has_the_drives_words(tmp_path):
    scenario = tmp_path / "error.yaml"
    scenario.write_text(
        "format: limber-scenario/1\nrobot: desktop2r\nduration_s: 1.5\n"
        "timeline:\n  - {at_s: 0.3, mode: hold}\n"
        "  - {at_s: 1.0, fault: {joint: elbow, kind: drive_error}}\n"
    )
    command = [sys.executable, "-m", "limber", "lab", str(scenario), "--out", str(tmp_path / "out")]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "elbow: error A: over-current\n" in done.stdout
    (told,) = json.loads((tmp_path / "out" / "summary.json").read_text())["faults"]
    assert told["measured"] == "error A: over-current"
