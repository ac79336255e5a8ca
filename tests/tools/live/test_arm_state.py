"""Quantities of an arm, from its two messages."""

import numpy as np
import pytest
from made_logs import records

from limber import messages
from limber.errors import InputError
from limber.live.arm_state import TARGET_COUNTS, Pose, State
from limber.live.arrival import RestWatch, Target

JOINTS = ("shoulder", "elbow")
HALF = np.sqrt(0.5)


def native(type_name: str, **fields) -> np.void:
    return records(type_name, 1, num_joints=2, **fields).astype(
        messages.native_dtype_of(type_name)
    )[0]


def state(status: dict | None = None, **fields) -> State:
    made = native("controller_status_t", **{"mode": 4, "law": 2, **(status or {})})
    made["quat_BT"][0] = made["quat_BD"][0] = 1.0
    return State(native("joint_state_t", **fields), made, JOINTS)


def test_joint_quantities_have_one_entry_a_joint():
    q = np.arange(16) / 10
    now = state(q=q, tau=-q, time_ns=1_500_000_000, drive_state=3)
    np.testing.assert_array_equal(now.q, [0.0, 0.1])
    np.testing.assert_array_equal(now.tau, [0.0, -0.1])
    assert now.q.dtype == float
    assert (now.time_s, now.mode, now.drives) == (1.5, "active", "on")


def test_targets_in_a_line():
    counts = {f"stream_{name}": i for i, name in enumerate(TARGET_COUNTS, 1)}
    now = state({"stream": 2, "stream_margin_s": -0.25, **counts})
    words = "1 taken, 2 late, 3 stale, 4 refused, 5 starved"
    assert str(now.targets) == f"targets waiting, margin -250 ms: {words}"
    assert str(state().targets).startswith("targets none: 0 taken")


def test_a_state_keeps_its_values():
    record = native("joint_state_t", q=np.ones(16))
    now = State(record, native("controller_status_t"), JOINTS)
    now.q[:] = 5.0
    np.testing.assert_array_equal(now.q, [1.0, 1.0])


def test_distance_of_poses():
    here = Pose(np.zeros(3), np.array([1.0, 0, 0, 0]))
    there = Pose(np.array([0.0, 3.0, 4.0]), np.array([HALF, 0, 0, -HALF]))
    assert here.distance(there) == pytest.approx((5.0, np.pi / 2))
    turned = Pose(here.p, -here.quat)  # the same orientation
    assert here.distance(turned) == pytest.approx((0.0, 0.0))
    np.testing.assert_allclose(there.R @ [1, 0, 0], [0, -1, 0], atol=1e-12)


def test_contact_is_unknown_without_a_source():
    with pytest.raises(InputError, match="no contact source"):
        _ = state().wrench
    felt = state({"contact": 2, "F_ext": [1.0, 2, 3, 4, 5, 6]})
    np.testing.assert_array_equal(felt.wrench, [1, 2, 3, 4, 5, 6])


def test_faults_in_words():
    assert state().faults == []
    (text,) = state({"mode": 4, "reason": 0}, fault=3, fault_joint=1).faults
    assert text.startswith("driver.REPLY_LOST (elbow): ") and "To do: " in text
    latched = state({"mode": 6, "reason": 10, "reason_joint": -1})
    assert [text.split(":")[0] for text in latched.faults] == ["controller.ENERGY"]


def test_a_stop_that_was_requested_is_no_fault_of_a_held_arm():
    assert state({"mode": 3, "reason": 6}).faults == []


def test_limits_and_warnings():
    assert state({"limits": 1 | 16}).limits == ["TORQUE", "SPRING"]
    assert state({"limits": 0}).limits == []
    assert state(joint_flags=np.array([3, 3 | 128] + [0] * 14)).warnings == [
        "joint.WARNING (elbow)"
    ]


def moving(t_s: float, q: float, goal: float = 0.0) -> State:
    status = {"p_BD": [goal, 0, 0]}
    return state(status, time_ns=round(t_s * 1e9), q=np.full(16, q))


def test_at_rest_is_who_stood_still_for_a_quarter_of_a_second():
    watch = RestWatch()
    times = np.arange(0, 0.6, 0.005)
    rests = [watch.at_rest(moving(t, 1.0)) for t in times]
    assert rests.index(True) == 50
    assert not watch.at_rest(moving(0.6, 1.003)), "a joint has moved"
    watch = RestWatch()
    slow = [watch.at_rest(moving(t, 1.0, goal=1e-9 * t)) for t in times]
    assert not any(slow), "the goal creeps"


def test_target_judges_what_was_requested():
    status = {"p_BT": [0.015, 0, 0]}
    turned = state(status)
    turned.status["quat_BT"] = [HALF, HALF, 0, 0]
    place = Target(tolerance_m=0.02, tolerance_rad=0.1)
    assert place.reached(turned) and place.missing(turned) == {"distance_m": pytest.approx(0.015)}
    pose = Target(turns=True, tolerance_m=0.02, tolerance_rad=0.1)
    assert not pose.reached(turned)
    assert pose.missing(turned)["angle_rad"] == pytest.approx(np.pi / 2)
    joints = Target(np.array([0.1, 0.3]), tolerance_rad=0.25)
    assert joints.missing(state()) == {"distance_rad": pytest.approx(0.3)}
    assert not joints.reached(state())
