"""A log becomes a scenario that does the same: what is written, and what it does when it is run."""

import subprocess

import numpy as np
import pytest
import yaml
from made_logs import records, write_log

from limber.black_box.reproduce import reproduction
from limber.log.reader import Log
from limber.messages import message_class
from limber.model.robot import load_robot
from limber.paths import program

State = message_class("joint_state_t")
Status = message_class("controller_status_t")
MS = 10**6
COUNT = 3000
JOINTS = [f"joint{i}" for i in range(1, 8)]


def channels(fault_at: int | None = None) -> dict[str, np.ndarray]:
    """Three seconds: a push of 5 N, softer from 1 s on, a goal 40 mm ahead from 2 s on."""
    time_ns = np.arange(COUNT) * MS
    state = records("joint_state_t", COUNT, time_ns=time_ns, num_joints=7, fault_joint=-1)
    state["joint_flags"][10:, :7] = State.JOINT_FRESH
    state["q"][:, 3] = 1.4
    status = records("controller_status_t", COUNT, time_ns=time_ns, num_joints=7, law=2)
    status["mode"] = Status.MODE_ACTIVE
    status["quat_BD"][:, 0] = 1.0
    for axis in range(3):
        status["K_x"][:, axis, axis] = np.interp(np.arange(COUNT), [1000, 1200], [500, 200])
    status["p_BD"][:, 0] = np.interp(np.arange(COUNT), [2000, 2500], [0.3, 0.34])
    truth = records("sim_truth_t", COUNT, time_ns=time_ns, num_joints=7)
    truth["q"] = state["q"]
    truth["F_push"][:, 1] = np.interp(np.arange(COUNT), [300, 400, 800, 900], [0, 5, 5, 0])
    if fault_at is not None:
        state["fault"][fault_at:], state["fault_joint"][fault_at:] = State.FAULT_REPLY_LOST, 2
        state["joint_flags"][fault_at - 30 :, 2] = 0
    return {"JOINT_STATE": state, "CONTROLLER_STATUS": status, "SIM_TRUTH": truth}


def entries(scenario: dict, kind: str) -> list[tuple[float, dict]]:
    return [(entry["at_s"], entry[kind]) for entry in scenario["timeline"] if kind in entry]


def test_law_goals_and_pushes_come_in_their_order(tmp_path):
    log = Log(write_log(tmp_path / "log", channels()))
    made = reproduction(log, "openarm", JOINTS)
    shift = 1.5 - 0.010  # the first state that counts is at 10 ms; the scenario needs time to start
    first, softer = entries(made.scenario, "gains")
    assert first[1]["law"] == "cartesian_impedance"
    assert first[1]["K_x_translation_N_per_m"] == [500, 500, 500]
    assert softer[0] == pytest.approx(1.0 + shift, abs=2e-3)
    assert softer[1]["K_x_translation_N_per_m"] == [200, 200, 200]
    assert softer[1]["ramp_s"] == pytest.approx(0.2, abs=2e-3)
    ((at_s, goal),) = entries(made.scenario, "goal")
    assert (at_s, goal["position_m"][0]) == pytest.approx((2.0 + shift, 0.34), abs=2e-3)
    assert goal["duration_s"] == pytest.approx(0.5, abs=2e-3)
    ((at_s, push),) = entries(made.scenario, "push")
    assert at_s == pytest.approx(0.3 + shift, abs=5e-3)
    assert push["force_N"] == pytest.approx([0, 5, 0], rel=0.02)
    assert push["for_s"] == pytest.approx(0.6, abs=0.01)
    assert made.cause is None and entries(made.scenario, "fault") == []


def test_it_ends_with_the_first_fault_which_began_when_the_drive_fell_silent(tmp_path):
    log = Log(write_log(tmp_path / "log", channels(fault_at=1500)))
    made = reproduction(log, "openarm", JOINTS)
    assert made.cause.code == "driver.REPLY_LOST"
    ((at_s, fault),) = entries(made.scenario, "fault")
    assert fault == {"joint": "joint3", "kind": "silent"}
    assert at_s == pytest.approx(1.469 + 1.49, abs=1e-3), "31 ms before it was found"
    assert entries(made.scenario, "goal") == [], "a goal after the fault"
    assert "driver.REPLY_LOST" in made.text()


def test_what_somebody_wanted_is_no_fault(tmp_path):
    made = channels()
    made["JOINT_STATE"]["fault"][2900:] = State.FAULT_REQUESTED
    made["CONTROLLER_STATUS"]["reason"][2905:] = Status.REASON_DRIVER_FAULT
    assert reproduction(Log(write_log(tmp_path / "log", made)), "openarm", JOINTS).cause is None


def test_a_log_without_drives_that_answered_makes_none(tmp_path):
    made = channels()
    made["JOINT_STATE"]["joint_flags"] = 0
    assert reproduction(Log(write_log(tmp_path / "log", made)), "openarm", JOINTS) is None


SCENARIO = """format: limber-scenario/1
robot: openarm
duration_s: 3
timeline:
  - {{at_s: 0.3, mode: hold}}
  - {{at_s: 0.8, mode: active}}
  - {{at_s: 1.0, gains: {{law: cartesian_impedance, K_x_translation_N_per_m: 300}}}}
  - {{at_s: 1.2, push: {{id: 1, force_N: [0, 8, 0], ramp_s: 0.2, for_s: 1.5}}}}
  - {{at_s: 1.3, goal: {{offset_m: [0.05, 0, 0], duration_s: 1.2}}}}
  - {{at_s: 1.8, fault: {{joint: joint4, kind: {kind}}}}}
"""


def lab(scenario, log) -> Log:
    command = [program("limber-lab"), scenario, "--log", log]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    return Log(log)


def first_fault(log: Log) -> tuple[str, int]:
    made = reproduction(log, "openarm", JOINTS)
    ((_, fault),) = entries(made.scenario, "fault")
    return made.cause.code, fault["joint"]


@pytest.mark.parametrize("kind", ["silent", "drive_error", "frozen_encoder"])
def test_the_scenario_leads_to_the_same_fault(tmp_path, kind):
    (tmp_path / "seen.yaml").write_text(SCENARIO.format(kind=kind))
    seen = lab(tmp_path / "seen.yaml", tmp_path / "seen.lcmlog")
    robot = load_robot("openarm")
    made = reproduction(seen, "openarm", robot.joint_names)
    path = tmp_path / "again.yaml"
    path.write_text(made.text())
    assert yaml.safe_load(path.read_text()) == made.scenario
    again = lab(path, tmp_path / "again.lcmlog")
    assert first_fault(again) == first_fault(seen)
