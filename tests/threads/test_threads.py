"""Driver and recorder under thread sanitizer, in lock step: slow programs change nothing there."""

import os
import subprocess
import sys

import yaml

from limber.paths import ROOT

SECONDS = 2.5
FAULT = {"at_s": 2.0, "fault": {"joint": "joint2", "kind": "drive_error", "for_s": 0.1}}


def test_no_race_from_the_start_to_a_fault_and_the_end(programs, races, tmp_path):
    """The state reporter speaks of states and fault; both planes and the recorder run."""
    scenario = yaml.safe_load((ROOT / "scenarios" / "quick.yaml").read_text(encoding="utf-8"))
    scenario.pop("measure", None)
    scenario["duration_s"] = SECONDS
    scenario["timeline"] = [e for e in scenario["timeline"] if e["at_s"] < SECONDS] + [FAULT]
    path = tmp_path / "fault.yaml"
    path.write_text(yaml.safe_dump(scenario), encoding="utf-8")
    command = [sys.executable, "-m", "limber", "run", path, "--lockstep", "--out", tmp_path / "out"]
    environment = {**os.environ, "LIMBER_BIN": str(programs)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300)
    told = (tmp_path / "out" / "limber-driver.log").read_text(encoding="utf-8")
    assert not races(), "\n".join(races())
    assert done.returncode == 0, done.stdout + done.stderr + told
    assert "drives: on" in told and "driver.DRIVE_ERROR" in told
