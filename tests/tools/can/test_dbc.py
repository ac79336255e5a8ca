"""DBC files as cantools reads them: frames worked out by hand, and the frames of a lab run."""

import math

import pytest

cantools = pytest.importorskip("cantools")


@pytest.fixture(scope="module")
def load(limber, tmp_path_factory):
    folder = tmp_path_factory.mktemp("dbc")

    def load_bus(robot: str, bus: str):
        done = limber("can", "dbc", robot, "--out", str(folder))
        assert done.returncode == 0, done.stderr
        return cantools.database.load_file(folder / f"{robot}_{bus}.dbc")

    return load_bus


def test_damiao_command_and_state(load):
    """openarm's joint 1: ±12.5 rad in 16 bits, ±45 rad/s and ±54 N m in 12, kp 500, kd 5."""
    database = load("openarm", "arm")
    command = database.decode_message(0x001, bytes.fromhex("8A3C7771EB4CC9FF"))
    assert command["position"] == pytest.approx(35388 * 25 / 65535 - 12.5)
    assert command["velocity"] == pytest.approx(1911 * 90 / 4095 - 45)
    assert command["kp"] == pytest.approx(491 * 500 / 4095)
    assert command["kd"] == pytest.approx(1228 * 5 / 4095)
    assert command["torque"] == pytest.approx(2559 * 108 / 4095 - 54)
    # Drives truncate: half a count more. Count 2047 of 4095 is exactly 0.
    state = database.decode_message(0x011, bytes.fromhex("D17FFF7FF7FF2926"))
    assert state["status"] == "no command within the drive's time-out"
    assert state["id"] == 1
    assert abs(state["position"]) < 1e-9 and abs(state["torque"]) < 1e-9
    assert (state["T_mos"], state["T_rotor"]) == (41, 38)
    message = database.get_message_by_frame_id(0x011)
    assert message.is_fd and message.length == 8 and message.senders == ["joint1"]
    torque = message.get_signal_by_name("torque")
    assert torque.unit == "N m" and torque.minimum == -54


def test_damiao_registers(load):
    database = load("desktop2r", "arm")
    request = database.decode_message(0x7FF, bytes.fromhex("0300550990010000"))
    assert request == {"id": 3, "operation": "write", "register": 9, "value": 400}
    assert not database.get_message_by_frame_id(0x7FF).is_fd


def test_moteus_command_and_state(load):
    """float32 at 0.1 turn, 0.85 N m; one 29-bit identifier, one of 11 bits."""
    database = load("planar2r", "arm")
    data = bytes.fromhex(
        "01000A 0C0620 CDCCCC3D 00000000 9A99593F CDCC4C3E CDCCCC3D 00001643 0D27 0AD7A33C"
    )
    command = database.decode_message(0x8001, data + b"\x50" * (48 - len(data)))
    assert command["mode"] == 10
    assert command["position"] == pytest.approx(0.1)
    assert command["feed_forward_torque"] == pytest.approx(0.85)
    assert command["kp_scale"] == pytest.approx(0.2)
    assert command["maximum_torque"] == 150
    assert command["watchdog"] == pytest.approx(0.02)
    message = database.get_message_by_name("shoulder_command")
    assert message.is_extended_frame and message.is_fd
    assert not database.get_message_by_name("shoulder_state").is_extended_frame


def test_canopen_pdos(load):
    """testbench: 2^24 counts a turn on both sides, rated torque 6.2 N m, all in one TPDO."""
    database = load("testbench", "arm")
    command = database.decode_message(0x201, bytes.fromhex("0F00C800"))
    assert command["controlword"] == 0x0F
    assert command["target_torque"] == pytest.approx(0.2 * 6.2)
    state = database.get_message_by_name("joint_TPDO1")
    decoded = state.decode(
        bytes.fromhex("3716 00004000 000000FF F1FF 0000 00002000 00000000 0000"),
        decode_choices=False,
    )
    assert decoded["statusword"] == 0x1637
    assert decoded["position"] == pytest.approx(math.pi / 2)
    assert decoded["velocity"] == pytest.approx(-2 * math.pi)
    assert decoded["torque"] == pytest.approx(-0.015 * 6.2)
    assert decoded["link_position"] == pytest.approx(math.pi / 4)
    assert database.decode_message(0x701, b"\x05") == {"state": "operational"}
    assert database.decode_message(0x000, b"\x81\x01") == {"command": "reset node", "node": 1}


def test_cubemars_states_are_of_all_motors(load):
    """Both reply under 0, and the first byte tells who: 12.5 rad, 50 rad/s, 15 N m."""
    database = load("desktop2r_ak", "arm")
    state = database.decode_message(0x000, bytes.fromhex("0277CE87A6212402"))
    assert (state["id"], state["T"], state["error"]) == (2, 36, 2)
    assert state["position"] == pytest.approx(-0.8, abs=25 / 65535)
    assert state["velocity"] == pytest.approx(3.0, abs=100 / 4095)
    assert state["torque"] == pytest.approx((1569.5 / 4095 * 2 - 1) * 15, abs=30 / 4095)
    command = database.decode_message(0x001, bytes.fromhex("77CE87A0CC28F621"))
    assert command["kp"] == pytest.approx(25, abs=500 / 4095)


def test_odrive_messages(load):
    database = load("desktop2r_odrive", "arm")
    estimates = database.decode_message(0x049, bytes.fromhex("87F9A23E0000C0BF"))
    assert estimates["position"] == pytest.approx(1 / math.pi, rel=1e-5)
    assert estimates["velocity"] == -1.5
    assert database.decode_message(0x04E, bytes.fromhex("CDCC4CBE")) == {
        "torque": pytest.approx(-0.2)
    }
    beat = database.decode_message(0x041, bytes.fromhex("0000000101030000"))
    assert (beat["error"], beat["state"], beat["result"]) == (1 << 24, 1, 3)
    told = database.decode_message(0x045, bytes.fromhex("00F30000CDCCCC3D"))
    assert (told["endpoint"], told["raw"]) == (243, 0x3DCCCCCD)


@pytest.mark.parametrize(
    "robot",
    ["antagonist2r", "baxter", "desktop2r", "desktop2r_ak", "desktop2r_odrive", "ideal7", "iiwa14"],
)
def test_every_robots_files_are_accepted(limber, tmp_path, robot):
    """cantools refuses signals that overlap or leave their frame."""
    done = limber("can", "dbc", robot, "--out", str(tmp_path))
    assert done.returncode == 0, done.stderr
    files = done.stdout.split()
    assert files
    for file in files:
        assert cantools.database.load_file(file, strict=True).messages
