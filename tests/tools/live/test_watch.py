"""The live view says what is going on, and says STALE when nothing is."""

import io
import time

import numpy as np
from rich.console import Console

from conftest import records
from limber import messages
from limber.live.listener import ChannelState
from limber.live.watch import PERIODIC, View
from limber.model.robot import JointInfo

JOINTS = [JointInfo("shoulder", -1.0, 1.0, 0.0), JointInfo("elbow", -np.inf, np.inf, 0.0)]
LAWS = ["gravity_compensation", "joint_pd", "cartesian_impedance"]


class Silent:
    """A listener nobody talks to."""

    def __init__(self):
        self.channels = {name: ChannelState() for name in PERIODIC}

    def newest(self, channel):
        data = self.channels[channel].data
        return messages.view(messages.channels()[channel].type_name, data) if data else None

    def hear(self, channel, record, age_s=0.0):
        heard = self.channels[channel]
        heard.data, heard.count, heard.last_s = record.tobytes(), 5, time.monotonic() - age_s
        heard.lost = 3


def text_of(listener) -> str:
    console = Console(width=120, record=True, file=io.StringIO())
    console.print(View(listener, JOINTS, LAWS).render())
    return console.export_text()


def listening() -> Silent:
    listener = Silent()
    state = records("joint_state_t", 1, num_joints=2, drive_state=3, fault_joint=-1)[0]
    state["q"][:2] = 0.9, -0.25
    status = records("controller_status_t", 1, mode=4, law=2, num_joints=2, limits=1)[0]
    status["p_BT"] = 0.274, -0.25, 0.53
    status["quat_BT"][0] = status["quat_BD"][0] = 1
    listener.hear("JOINT_STATE", state)
    listener.hear("CONTROLLER_STATUS", status)
    return listener


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
    listener = listening()
    status = records("controller_status_t", 1, mode=4, law=2, num_joints=2, contact=2)[0]
    status["quat_BT"][0] = status["quat_BD"][0] = 1
    status["F_ext"] = 4.26, -1.5, 0, 0.31, 0, -0.22
    status["term_period_cycles"] = 1, 4, 1, 1, 25
    status["tank_energy_J"], status["passivity_energy_J"] = 0.125, -0.031
    listener.hear("CONTROLLER_STATUS", status)
    text = text_of(listener)
    assert "joint torque" in text and "M 4, D 25 cycles" in text
    assert "+4.3" in text and "-1.5" in text and "+0.31" in text and "-0.22" in text
    assert "+0.125" in text and "-0.031" in text


def test_bar_shows_where_between_the_limits():
    line = next(line for line in text_of(listening()).splitlines() if "shoulder" in line)
    bar = line[line.index("─") : line.rindex("─") + 1]
    assert bar.index("●") == 14 and len(bar) == 16


def test_old_messages_are_stale():
    listener = listening()
    state = listener.newest("JOINT_STATE").astype(messages.dtype_of("joint_state_t"))
    state[messages.FINGERPRINT] = messages.fingerprint_of("joint_state_t")
    listener.hear("JOINT_STATE", state, age_s=5.0)
    assert "STALE: no driver" in text_of(listener)


def test_fault_names_the_joint():
    listener = listening()
    state = records("joint_state_t", 1, num_joints=2, drive_state=6, fault=3, fault_joint=1)[0]
    listener.hear("JOINT_STATE", state)
    text = text_of(listener)
    assert text.count("driver.REPLY_LOST") == 2 and "(elbow)" in text
    assert "To do: check power, cable" in text
