"""Targets of a script as messages: sixteen knots each, in the machine's units, checked."""

import numpy as np
import pytest

from limber.errors import InputError
from limber.live import stream_messages
from limber.live.script_client import script_client
from limber.messages import CLIENT_WITH_LOCK
from limber.model.rotations import quaternion_of, turned_about


def made(times, **given):
    return list(stream_messages.targets(7, np.asarray(times, float), given))


def test_a_chunk_of_fifty_is_four_messages_that_fit_a_datagram():
    actions = np.arange(350.0).reshape(50, 7) / 1000
    messages = made(0.02 * np.arange(50), joints_rad=actions, hand_width_m=0.04, valid_for_s=1)
    assert [message.num_knots for message in messages] == [16, 16, 16, 2]
    knots = [row[:7] for message in messages for row in message.value[: message.num_knots]]
    np.testing.assert_allclose(knots, actions)
    assert [message.dt_s[0] for message in messages] == pytest.approx([0, 0.32, 0.64, 0.96])
    assert messages[3].hand_width_m[:2] == [0.04, 0.04] and messages[3].use_hand == 1
    assert all(len(message.encode()) < 1400 for message in messages)


def test_kinds_and_defaults():
    (pose,) = made([0], position_m=[[1, 2, 3]], quaternion_wxyz=[[1, 0, 0, 0]])
    assert pose.kind == pose.KIND_POSE and pose.value[0][:7] == [1, 2, 3, 1, 0, 0, 0]
    (twist,) = made([0], twist=[[0, 0, 0.1, 0, 0, 0]], stiffness_scale=0.5, force_N=[0, 0, 9])
    assert twist.kind == twist.KIND_TWIST
    assert (twist.stiffness_scale, twist.F_ff) == (0.5, [0, 0, 9, 0, 0, 0])
    assert (pose.stiffness_scale, pose.use_hand, pose.F_ff) == (0, 0, [0] * 6)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({}, "a target is one of"),
        ({"joints_rad": [[0] * 7], "twist": [[0] * 6]}, "a target is one of"),
        ({"joints_rad": [[0] * 6]}, "expected 1 x 7 numbers"),
        ({"joints_rad": [[np.nan] * 7]}, "not finite"),
        ({"position_m": [[0, 0, 0]]}, "belong together"),
        ({"twist": [[0] * 6], "quaternion_wxyz": [[1, 0, 0, 0]]}, "goes with position_m"),
        ({"position_m": [[0] * 3], "quaternion_wxyz": [[1, 1, 0, 0]]}, "unit quaternions"),
        ({"twist": [[0] * 6], "hand_width_m": np.nan}, "not finite"),
        ({"twist": [[0] * 6], "stiffness_scale": 2}, "0.05 to 1"),
        ({"twist": [[0] * 6], "stifness": 1}, "'stifness' is no key"),
    ],
)
def test_what_is_no_target_is_an_error(given, words):
    with pytest.raises(InputError, match=words):
        made([0], **given)


def test_quaternions_go_out_at_length_one():
    quat = quaternion_of(turned_about(np.array([0.3, -0.2, 0.1]))) * 1.0005
    (pose,) = made([0], position_m=[[0, 0, 0]], quaternion_wxyz=[quat])
    assert np.linalg.norm(pose.value[0][3:7]) == pytest.approx(1.0, abs=1e-12)


def test_an_overlay_names_its_end():
    message = stream_messages.overlay(7, [1.0] * 7, 0.01)
    assert message.tau[:8] == [1.0] * 7 + [0.0] and message.valid_for_s == 0.01
    with pytest.raises(InputError, match=r"0.001 to 0.05"):
        stream_messages.overlay(7, [1.0] * 7, 0.06)


def test_a_process_has_one_number_and_its_lock():
    assert script_client() == script_client()
    assert script_client() & CLIENT_WITH_LOCK
