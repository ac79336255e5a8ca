"""Numpy's view of a message is what the generated class decodes."""

import numpy as np
import pytest

from limber import messages

FIXED = [
    "joint_state_t",
    "joint_command_t",
    "controller_status_t",
    "driver_status_t",
    "sim_truth_t",
    "compliance_goal_t",
    "hand_goal_t",
    "hand_state_t",
    "hand_truth_t",
    "mode_request_t",
    "scenario_event_t",
]


def filled(type_name: str):
    """A message with a different number in every element of every field."""
    message = messages.message_class(type_name)()
    number = 0
    for name, shape in zip(message.__slots__, message.__dimensions__, strict=True):
        count = int(np.prod(shape or [1]))
        values = (np.arange(number, number + count) % 100).reshape(shape or [1]).tolist()
        setattr(message, name, values if shape else values[0])
        number += count
    return message


@pytest.mark.parametrize("type_name", FIXED)
def test_view_equals_generated_decode(type_name):
    message = filled(type_name)
    record = messages.view(type_name, message.encode())
    for name in message.__slots__:
        np.testing.assert_array_equal(record[name], getattr(message, name), err_msg=name)


@pytest.mark.parametrize("type_name", FIXED)
@pytest.mark.parametrize("count", [0, 1, messages.IN_CACHE, messages.IN_CACHE + 1])
def test_views_turn_all_bytes_round(type_name, count):
    size = messages.dtype_of(type_name).itemsize
    parts = [np.random.default_rng(i).bytes(size) for i in range(count)]
    records = messages.views(type_name, parts)
    assert records.dtype == messages.native_dtype_of(type_name)
    again = records.astype(messages.dtype_of(type_name))
    assert [record.tobytes() for record in again] == parts


@pytest.mark.parametrize("type_name", ["compliance_gains_t", "push_t"])
def test_types_with_strings_have_no_fixed_layout(type_name):
    assert messages.dtype_of(type_name) is None


def test_view_refuses_other_types_and_sizes():
    data = filled("joint_state_t").encode()
    with pytest.raises(ValueError, match="joint_command_t"):
        messages.view("joint_command_t", data)
    with pytest.raises(ValueError, match="joint_state_t"):
        messages.view("joint_state_t", data[:-1])
    with pytest.raises(ValueError, match="version"):
        messages.view("joint_state_t", b"\0" * 8 + data[8:])


def test_every_channel_of_the_table_has_a_type():
    for channel in messages.channels().values():
        assert messages.message_class(channel.type_name)().encode()


def test_names_of_constants_and_bits():
    assert messages.constants("joint_state_t", "DRIVE_")[3] == "ON"
    assert messages.bit_names("controller_status_t", "LIMIT_", 1 | 8) == ["TORQUE", "VELOCITY"]
