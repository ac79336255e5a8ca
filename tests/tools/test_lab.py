"""A lab in Python's process: the same bytes as limber-lab's, and nothing shared."""

import threading

import numpy as np
import pytest

from limber.errors import InputError, RunError
from limber.lab import Lab, RefusedByLabError
from limber.live import request_messages, stream_messages
from limber.log.reader import Log
from limber.messages import decode, message_class
from limber.paths import completed, program

CHANNELS = ("JOINT_STATE", "JOINT_TORQUE", "SIM_TRUTH", "CONTROLLER_STATUS", "DRIVER_STATUS")


def target(joints: int, up_m: float, lab: Lab):
    p, quat = (lab.message("CONTROLLER_STATUS")[key] for key in ("p_BT", "quat_BT"))
    pose = {"position_m": [p + np.array([0.0, 0.0, up_m])], "quaternion_wxyz": [quat]}
    message = next(stream_messages.targets(joints, np.zeros(1), {**pose, "delay_s": 0.05}))
    message.t0_ns = message.NOW
    return message


def run(scenario, into: list) -> None:
    """A second of a stream, a push and a payload, every message of it kept."""
    with Lab(scenario) as lab:
        lab.step(1500)
        lab.send(request_messages.payload(0.4, [0.0, 0.0, 0.05]))
        lab.send(request_messages.push([5.0, 0.0, 0.0], None, 0.5, 0.1, "", 1))
        for k in range(20):
            lab.send(target(7, 0.005 * (k % 2), lab))
            lab.step(50)
            into.append([lab.message_bytes(channel) for channel in CHANNELS])


def test_same_bytes_in_turn_and_beside_each_other():
    """Both integrators, one after the other and all at once: no lab notices another one."""
    scenarios = [{"robot": "openarm", "integrator": word} for word in ("reference", "ode")] * 2
    alone = [[] for _ in scenarios[:2]]
    for scenario, kept in zip(scenarios, alone, strict=False):
        run(scenario, kept)
    assert alone[0] != alone[1]
    beside = [[] for _ in scenarios]
    threads = [
        threading.Thread(target=run, args=pair) for pair in zip(scenarios, beside, strict=True)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert beside == [alone[0], alone[1]] * 2


def test_the_lab_of_the_command_line_gives_the_same_bytes(tmp_path):
    log = tmp_path / "run.lcmlog"
    completed([str(program("limber-lab")), "scenarios/quick.yaml", "--log", str(log)])
    recorded = Log(log)
    with Lab("quick") as lab:
        lab.step(3000)
        for channel in ("JOINT_STATE", "JOINT_TORQUE", "SIM_TRUTH"):
            assert lab.message_bytes(channel) == recorded.raw(channel)[-1], channel


def test_cycles_run_without_pythons_lock():
    """While one thread is in a long step, another one goes on."""
    with Lab({"robot": "openarm"}) as lab:
        thread = threading.Thread(target=lab.step, args=(20_000,))
        thread.start()
        turns = 0
        while thread.is_alive():
            turns += 1
        thread.join()
    assert turns > 100


def test_requests_act_and_are_refused_with_a_reason():
    with Lab({"robot": "openarm"}) as lab:
        with pytest.raises(InputError, match="no cycle"):
            lab.message("JOINT_STATE")
        lab.step(1)
        goal = request_messages.goal(7, offset_m=[0.05, 0.0, 0.0])
        with pytest.raises(RefusedByLabError, match=r"COMPLIANCE_GOAL refused: .*ACTIVE"):
            lab.send(goal)
        answer = decode("request_answer_t", lab.message_bytes("REQUEST_ANSWER"))
        assert (answer.accepted, answer.code) == (0, answer.REFUSED_MODE)
        lab.step(1500)
        start = lab.message("CONTROLLER_STATUS")["p_BD"].copy()
        lab.send(goal)
        lab.step(3000)
        moved = lab.message("CONTROLLER_STATUS")["p_BD"] - start
        np.testing.assert_allclose(moved, [0.05, 0.0, 0.0], atol=1e-6)
        lab.send(request_messages.wall([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], 1000.0, 10.0))
        lab.send(request_messages.push([5.0, 0.0, 0.0], None, 0.5, 0.1, "", 1))
        with pytest.raises(RefusedByLabError, match="no such link"):
            lab.send(request_messages.push([5.0, 0.0, 0.0], None, 0.5, 0.1, "link99", 1))


def test_gravity_compensation_holds_what_the_scale_says():
    """Two arms of the same scenario, one with a payload: the tip sinks by m g / K."""
    tips = []
    for mass_kg in (0.0, 0.5):
        scenario = {"robot": "ideal7", "friction": False}
        with Lab(scenario) as lab:
            lab.step(1500)
            if mass_kg:
                lab.send(request_messages.payload(mass_kg, [0.0, 0.0, 0.0]))
            lab.step(4000)
            status = lab.message("CONTROLLER_STATUS")
            tips.append(lab.message("SIM_TRUTH")["p_BT"][2])
            stiffness = status["K_x"][2, 2]
    assert tips[0] - tips[1] == pytest.approx(0.5 * 9.81 / stiffness, rel=0.05)


@pytest.mark.parametrize(
    ("scenario", "words"),
    [
        ({"robot": "openarm", "speed": 3}, "unknown key 'speed'"),
        ({"robot": "no_such_arm"}, "no_such_arm"),
        ({"robot": "openarm", "law_file": "x.so"}, "law_file"),
        ({"robot": "openarm", "duration_s": float("nan")}, "scenario:.*duration_s"),
        ("format: limber-scenario/1\n\t: [", "not valid YAML|tab"),
        ("no_such_file.yaml", "does not exist"),
    ],
)
def test_wrong_scenarios_are_told_with_file_and_key(scenario, words):
    with pytest.raises(InputError, match=words):
        Lab(scenario)


def test_bytes_that_are_no_message_are_refused():
    with Lab({"robot": "openarm"}) as lab:
        lab.step(1)
        good = message_class("push_t")().encode()
        for data in (b"", good[:-1], good + b"\0", bytes(len(good))):
            with pytest.raises(InputError, match="not a message"):
                lab.send_bytes("PUSH", data)
        for channel in ("JOINT_STATE", "NO_SUCH", "PÜSH"):
            with pytest.raises(InputError, match="no such channel"):
                lab.send_bytes(channel, good)
        with pytest.raises(InputError, match="no such channel"):
            lab.message_bytes("PUSH")
        with pytest.raises(InputError, match="less than 0"):
            lab.step(-1)
    lab.close()
    with pytest.raises(RunError, match="closed"):
        lab.step(1)
