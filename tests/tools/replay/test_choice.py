"""No command leaves a log by itself, and nothing goes to an arm."""

import pytest

from limber import messages
from limber.errors import InputError
from limber.replay.address import address
from limber.replay.choice import choose

COMMANDS = {"JOINT_TORQUE", "MODE_REQUEST", "COMPLIANCE_GOAL", "COMPLIANCE_GAINS", "PUSH"}
COMMANDS |= {
    "EPISODE",
    "SCENARIO_EVENT",
    "HAND_GOAL",
    "TARGET_STREAM",
    "TORQUE_OVERLAY",
    "WORKPIECE",
}
ALL = set(messages.channels())
PRIVATE = "udpm://239.255.76.67:7700?ttl=0"


def test_commands_are_left_out_and_told():
    sent, left_out = choose([*ALL, "OTHER"], (), "", False)
    assert set(sent) == ALL - COMMANDS
    assert all(name == under for name, under in sent.items())
    assert set(left_out) == COMMANDS | {"OTHER"}
    assert "--commands-as" in left_out["PUSH"] and "not a channel" in left_out["OTHER"]


def test_commands_under_another_name():
    sent, left_out = choose(ALL, (), "REPLAY_", False)
    assert {sent[name] for name in COMMANDS} == {f"REPLAY_{name}" for name in COMMANDS}
    assert not left_out


def test_commands_as_they_are_only_when_asked():
    assert choose(ALL, (), "", True)[0] == {name: name for name in ALL}


def test_only_some_channels():
    sent, left_out = choose([*ALL, "OTHER"], ("JOINT_STATE", "OTHER", "PUSH"), "", False)
    assert set(sent) == {"JOINT_STATE", "OTHER"}
    assert "commands" in left_out["PUSH"] and left_out["SIM_TRUTH"] == "not in --channels"
    with pytest.raises(InputError, match="JOINT_STATE"):
        choose(ALL, ("JOINT_SATE",), "", False)


@pytest.mark.parametrize("url", [None, "udpm://239.255.76.67:7667?ttl=0"])
def test_where_tools_listen_is_not_private(url, monkeypatch):
    monkeypatch.delenv("LCM_DEFAULT_URL", raising=False)
    assert not address(url).private
    assert address(PRIVATE).private


def test_a_default_of_the_users_own_is_not_private(monkeypatch):
    monkeypatch.setenv("LCM_DEFAULT_URL", PRIVATE)
    assert not address(None).private
    assert not address(PRIVATE).private


@pytest.mark.parametrize(
    ("url", "said"),
    [
        ("udpm://239.255.76.68:7668?ttl=0", "arm plane"),
        ("udpm://239.255.99.99:7668?ttl=0", "arm plane"),  # another group, but its sockets hear it
        ("udpm://239.255.76.67:7700", "leave this machine"),
        ("udpm://239.255.76.67:7700?ttl=1", "leave this machine"),
        ("udpm://239.255.76.67:7700?ttl=0&ttl=3", "leave this machine"),
        ("udpm://239.255.76.67?ttl=0", "GROUP:PORT"),
        ("udpm://:7700?ttl=0", "GROUP:PORT"),
        ("udpm://239.255.76.67:77000?ttl=0", "GROUP:PORT"),
        ("file:///tmp/x", "GROUP:PORT"),
        ("nonsense", "GROUP:PORT"),
    ],
)
def test_addresses_that_are_refused(url, said):
    with pytest.raises(InputError, match=said):
        address(url)
