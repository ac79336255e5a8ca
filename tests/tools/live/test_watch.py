"""The live view says what is going on, and says STALE when nothing is."""

import io
import time
from types import SimpleNamespace

import numpy as np
import pytest
from made_logs import records
from rich.console import Console

from limber import messages
from limber.lcmtypes.robot_info_t import robot_info_t as RobotInfo
from limber.live import watch
from limber.live.receiver import ChannelState
from limber.live.watch import PERIODIC, View
from limber.model.robot import JointInfo

JOINTS = [JointInfo("shoulder", -1.0, 1.0, 0.0), JointInfo("elbow", -np.inf, np.inf, 0.0)]


@pytest.fixture(autouse=True)
def known_arm(monkeypatch):
    """The files of the arm that ROBOT_INFO names."""
    found = SimpleNamespace(joints=JOINTS)
    monkeypatch.setattr(watch, "load_robot", {"/arms/two": found}.__getitem__)


LAWS = ["gravity_compensation", "joint_pd", "cartesian_impedance"]


class Silent:
    """A receiver nobody talks to."""

    def __init__(self):
        table = messages.channels()
        self.channels = {name: ChannelState(table[name].type_name) for name in PERIODIC}

    def newest(self, channel):
        data = self.channels[channel].data
        return messages.view(messages.channels()[channel].type_name, data) if data else None

    def hear(self, channel, record, age_s=0.0):
        heard = self.channels[channel]
        heard.data, heard.count, heard.last_s = record.tobytes(), 5, time.monotonic() - age_s
        heard.lost = 3


def text_of(receiver) -> str:
    console = Console(width=120, record=True, file=io.StringIO())
    console.print(View(receiver, LAWS).render())
    return console.export_text()


def listening() -> Silent:
    receiver = Silent()
    state = records("joint_state_t", 1, num_joints=2, drive_state=3, fault_joint=-1)[0]
    state["q"][:2] = 0.9, -0.25
    status = records("controller_status_t", 1, mode=4, law=2, num_joints=2, limits=1)[0]
    status["p_BT"] = 0.274, -0.25, 0.53
    status["quat_BT"][0] = status["quat_BD"][0] = 1
    receiver.hear("JOINT_STATE", state)
    receiver.hear("CONTROLLER_STATUS", status)
    info = RobotInfo()
    info.robot, info.folder, info.simulated = "two", "/arms/two", 1
    heard = receiver.channels["ROBOT_INFO"]
    heard.data, heard.count, heard.last_s = info.encode(), 1, time.monotonic()
    return receiver


def test_the_stack_names_its_arm_and_stiffness():
    receiver = listening()
    status = records("controller_status_t", 1, mode=4, law=2, num_joints=2)[0]
    status["quat_BT"][0] = status["quat_BD"][0] = 1
    status["K_x"][:] = np.diag([510, 520, 530, 21.5, 22.5, 23.5])
    receiver.hear("CONTROLLER_STATUS", status)
    text = text_of(receiver)
    assert "two, simulated" in text
    assert "510" in text and "530" in text and "N/m" in text
    assert "21.5" in text and "N m/rad" in text


@pytest.mark.parametrize(("mode", "shown"), [("FAULT", True), ("HOLD", False), ("ACTIVE", False)])
def test_a_cause_ends_when_it_ends(mode, shown):
    """The reason stays in the status until the next one; it is shown while the mode it caused is
    on.
    """
    receiver = listening()
    kinds = messages.message_class("controller_status_t")
    number = getattr(kinds, f"MODE_{mode}")
    reason = kinds.REASON_STATE_LOST
    status = records("controller_status_t", 1, mode=number, reason=reason, reason_joint=-1)[0]
    status["quat_BT"][0] = status["quat_BD"][0] = 1
    receiver.hear("CONTROLLER_STATUS", status)
    assert ("controller.STATE_LOST" in text_of(receiver)) == shown


def test_nobody_there():
    text = text_of(Silent())
    assert "STALE: no controller" in text
    assert "STALE: no driver" in text
    assert text.count("STALE") >= len(PERIODIC)


def test_tells_mode_law_drives_joints():
    text = text_of(listening())
    assert "ACTIVE" in text and "cartesian_impedance" in text and "ON" in text
    assert "shoulder" in text and "+0.900" in text and "-0.250" in text
    assert "TORQUE" in text, "an active limit is shown"
    assert "STALE: no" not in text


def test_only_settings_that_are_not_default():
    text = text_of(listening())
    assert "contact" not in text and "cycles" not in text


def test_contact_settings_and_energies():
    receiver = listening()
    status = records("controller_status_t", 1, mode=4, law=2, num_joints=2, contact=2)[0]
    status["quat_BT"][0] = status["quat_BD"][0] = 1
    status["F_ext"] = 4.26, -1.5, 0, 0.31, 0, -0.22
    status["term_period_cycles"] = 1, 4, 1, 1, 25
    status["tank_energy_J"], status["passivity_energy_J"] = 0.125, -0.031
    receiver.hear("CONTROLLER_STATUS", status)
    text = text_of(receiver)
    assert "joint torque" in text and "M 4, D 25 cycles" in text
    assert "+4.3" in text and "-1.5" in text and "+0.31" in text and "-0.22" in text
    assert "+0.125" in text and "-0.031" in text


def test_bar_shows_where_between_the_limits():
    line = next(line for line in text_of(listening()).splitlines() if "shoulder" in line)
    bar = line[line.index("─") : line.rindex("─") + 1]
    assert bar.index("●") == 14 and len(bar) == 16


def test_old_messages_are_stale():
    receiver = listening()
    state = receiver.newest("JOINT_STATE").astype(messages.dtype_of("joint_state_t"))
    state[messages.FINGERPRINT] = messages.fingerprint_of("joint_state_t")
    receiver.hear("JOINT_STATE", state, age_s=5.0)
    assert "STALE: no driver" in text_of(receiver)


def test_fault_names_the_joint():
    receiver = listening()
    state = records("joint_state_t", 1, num_joints=2, drive_state=6, fault=3, fault_joint=1)[0]
    receiver.hear("JOINT_STATE", state)
    text = text_of(receiver)
    assert text.count("driver.REPLY_LOST") == 2 and "(elbow)" in text
    assert "To do: if limber-driver" in text


def test_all_words_are_whole_in_eighty_columns():
    """The longest law, cause and numbers there are."""
    receiver = listening()
    kinds = messages.message_class("controller_status_t")
    state = records("joint_state_t", 1, num_joints=2, drive_state=6, fault=3, fault_joint=1)[0]
    state["q"][:2], state["v"][:2], state["tau"][:2] = -1.234, -12.345, -123.45
    status = records("controller_status_t", 1, mode=kinds.MODE_FAULT, law=2, num_joints=2)[0]
    status["reason"] = kinds.REASON_SESSION_CHANGED
    status["limits"] = kinds.LIMIT_STATIC_UNSOLVED | kinds.LIMIT_STIFFNESS
    status["p_BT"], status["quat_BT"][0], status["quat_BD"][0] = -0.2745, 1, 1
    status["K_x"][:] = np.diag([20000.0] * 3 + [1000.5] * 3)
    status["contact"], status["F_ext"] = 1, -123.4
    receiver.hear("JOINT_STATE", state)
    receiver.hear("CONTROLLER_STATUS", status)
    console = Console(width=80, record=True, file=io.StringIO())
    console.print(View(receiver, LAWS).render(80))
    text = console.export_text()
    assert "…" not in text
    for word in ("position", "stiffness", "SESSION_CHANGED", "cartesian_impedance"):
        assert word in text
    assert "-0.2745 -0.2745 -0.2745 m" in text and "STATIC_UNSOLVED" in text


def test_long_names_take_the_room_of_the_bars(monkeypatch):
    joints = [JointInfo(f"left_shoulder_pan_joint_{i}", -1.0, 1.0, 0.0) for i in range(2)]
    monkeypatch.setattr(watch, "load_robot", lambda _folder: SimpleNamespace(joints=joints))
    console = Console(width=80, record=True, file=io.StringIO())
    console.print(View(listening(), LAWS).render(80))
    text = console.export_text()
    assert "left_shoulder_pan_joint_1" in text and "●" not in text and "…" not in text


def test_names_are_no_markup(monkeypatch):
    joints = [JointInfo("[red]a[/]", -1.0, 1.0, 0.0)] * 2
    monkeypatch.setattr(watch, "load_robot", lambda _folder: SimpleNamespace(joints=joints))
    assert "[red]a[/]" in text_of(listening())
