"""`limber motors dump` and `restore`: what the emulated drives have stored, as a file and back."""

from __future__ import annotations

import struct

import can
import pytest
import yaml
from local_drive import multicast_group
from motor_bus import forgetful_drive, frames_of, sending

TIMEOUT, OVER_TEMPERATURE = "TIMEOUT (counts of 50 us)", "over-temperature limit (degC)"
EDITS = {
    "desktop2r": {TIMEOUT: 400, "TMAX (N m)": 12.3, OVER_TEMPERATURE: 90},
    "edulite_a3": {"CAN time-out (counts of 50 us, 0: off)": 20000},
    "planar2r": {"servo.default_velocity_limit": 2.5, "servo.pid_position.kp": 3000.0},
    "testbench": {
        "6072h:00 maximum torque (thousandths)": 500,
        "6007h:00 connection lost option": 2,
    },
}
WRITES = (0x55, 0xAA)  # third byte of a Damiao drive's register frames: write, store
TORQUE = can.Message(arbitration_id=1, data=b"\x7f\xff\x7f\xf0\0\0\x07\xff", is_extended_id=False)


@pytest.fixture
def kept(motors, limber, tmp_path):
    """Of the simulated arm: its dump as a dictionary, and restore() of one."""
    path = tmp_path / "motors.yaml"

    def start(robot: str):
        call = motors(robot)

        def dump() -> dict:
            done = call("dump", "--out", str(path))
            assert done.returncode == 0, done.stderr
            return yaml.safe_load(path.read_text(encoding="utf-8"))

        def restore(content: dict | str):
            text = content if isinstance(content, str) else yaml.safe_dump(content, sort_keys=False)
            path.write_text(text.replace(".nan", "nan"), encoding="utf-8")
            return limber("motors", "restore", str(path))

        return dump, restore

    return start


def first(content: dict) -> dict:
    return content["buses"][0]["motors"][0]


def raw_register(robot: str, number: int, register: int) -> int:
    """As the drive's manual has it, and not as limber reads it."""
    with can.Bus(interface="udp_multicast", channel=multicast_group(robot), hop_limit=0) as bus:
        data = bytes((number, 0, 0x33, register, 0, 0, 0, 0))
        bus.send(can.Message(arbitration_id=0x7FF, data=data, is_extended_id=False))
        while answer := bus.recv(5.0):
            if answer.arbitration_id != 0x7FF and bytes(answer.data[:4]) == data[:4]:
                return struct.unpack("<I", answer.data[4:])[0]
    raise AssertionError("no answer")


@pytest.mark.parametrize("robot", sorted(EDITS))
def test_edited_settings_are_written_once(kept, robot):
    dump, restore = kept(robot)
    wanted = dump()
    before = {name: first(wanted)["settings"][name] for name in EDITS[robot]}
    first(wanted)["settings"] |= EDITS[robot]
    done = restore(wanted)
    assert done.returncode == 0, done.stderr
    for name, value in EDITS[robot].items():
        assert any(
            name in line and line.endswith(f"in the file {value}")
            for line in done.stdout.splitlines()
        )
        assert before[name] != value
    assert f"{len(EDITS[robot])} written and read back" in done.stdout
    assert ("it cannot store" in done.stdout) == (robot == "testbench")
    found = dump()
    assert str(found) == str(wanted)  # NaN is not equal to itself
    again = restore(wanted)
    assert (again.returncode, again.stdout) == (0, "nothing to write\n")


def test_the_drive_has_them_and_a_second_restore_sends_no_write(kept):
    dump, restore = kept("desktop2r")
    wanted = dump()
    first(wanted)["settings"][TIMEOUT] = 400
    with frames_of("desktop2r") as heard:
        assert restore(wanted).returncode == 0
    writes = [
        bytes(frame.data).hex()
        for frame in heard
        if frame.arbitration_id == 0x7FF and frame.data[2] in WRITES
    ]
    assert writes == ["0100550990010000", "0100aa0100000000"]
    assert raw_register("desktop2r", 1, 9) == 400
    with frames_of("desktop2r") as heard:
        assert restore(wanted).returncode == 0
    requests = [frame.data[2] for frame in heard if frame.arbitration_id == 0x7FF]
    assert requests and not set(requests) & set(WRITES)


def test_what_cannot_be_written_is_compared(kept):
    dump, restore = kept("axol")
    wanted = dump()
    mixed = wanted["buses"][0]["motors"]
    assert [motor["motor"] for motor in mixed][:3] == [
        "damiao_mit:6",
        "damiao_mit:7",
        "myactuator:1",
    ]
    mixed[0]["compared"] |= {"MST_ID": 0x55, "can_br": 9}
    mixed[2]["compared"]["firmware"] = 2024010101
    done = restore(wanted)
    assert done.returncode == 0, done.stderr
    for line in (
        "MST_ID: 22, in the file 85",
        "can_br: 4, in the file 9",
        "in the file 2024010101",
    ):
        assert f"{line}: restore does not write this" in done.stdout
    assert done.stdout.endswith("nothing to write\n")


WRONG = [
    (lambda file: first(file).update(motor="damiao_mit:9"), 3, "damiao_mit:9 does not answer"),
    (lambda file: first(file)["model"].update({"gear ratio": 40}), 2, "another motor: it has 10"),
    (lambda file: first(file).update(motor="telepath:1"), 2, "no family 'telepath'"),
    (lambda file: first(file).update(motor="robstride:1"), 3, "robstride:1 does not answer"),
    (lambda file: first(file)["settings"].update({TIMEOUT: -1}), 2, "-1"),
    (lambda file: first(file)["settings"].update({TIMEOUT: 5e9}), 2, "5000000000"),
    (lambda file: first(file)["settings"].update({"TMAX (N m)": 1e39}), 2, "1.0e+39"),
    (lambda file: first(file)["settings"].update({"TMAX (N m)": "nan"}), 2, "nan"),
    (lambda file: first(file)["settings"].update({"MST_ID": 3}), 2, "nothing of this name here"),
    (lambda file: first(file).update(wishes={}), 2, "unknown key 'wishes'"),
    (lambda file: file.update(format="limber-motors/2"), 2, "limber-motors/1"),
    (lambda file: file.pop("complete"), 2, "'complete' is missing"),
]  # fmt: skip


def test_a_wrong_file_writes_nothing(kept):
    dump, restore = kept("desktop2r")
    right = dump()
    for spoil, code, said in WRONG:
        wrong = dump()
        wrong["buses"][0]["motors"][1]["settings"][TIMEOUT] = 400  # the second motor is fine
        spoil(wrong)
        done = restore(wrong)
        assert (done.returncode, said in done.stderr) == (code, True), done.stderr
    assert dump() == right


def test_a_cut_file_is_refused_wherever_it_ends(kept, tmp_path):
    dump, restore = kept("desktop2r")
    right = dump()
    lines = (tmp_path / "motors.yaml").read_text(encoding="utf-8").splitlines(keepends=True)
    for count in (0, 3, 9, 20, len(lines) - 1):
        done = restore("".join(lines[:count]))
        assert done.returncode == 2 and "motors.yaml" in done.stderr, (count, done.stderr)
    assert dump() == right


def test_a_value_that_the_drive_refuses(kept):
    """Its maker's range is 80 to 200."""
    dump, restore = kept("desktop2r")
    wanted = dump()
    first(wanted)["settings"][OVER_TEMPERATURE] = 300
    done = restore(wanted)
    assert done.returncode == 3 and "the drive refused" in done.stderr
    assert first(dump())["settings"][OVER_TEMPERATURE] == 100


def test_a_running_stack_and_a_motor_that_is_on(kept):
    dump, restore = kept("desktop2r")
    wanted = dump()
    first(wanted)["settings"][TIMEOUT] = 400
    with sending("desktop2r", TORQUE):
        done = restore(wanted)
    assert done.returncode == 3 and "somebody sends on this bus" in done.stderr
    with can.Bus(
        interface="udp_multicast", channel=multicast_group("desktop2r"), hop_limit=0
    ) as bus:
        enable = bytes([0xFF] * 7 + [0xFC])
        bus.send(can.Message(arbitration_id=2, data=enable, is_extended_id=False))
    done = restore(wanted)
    assert done.returncode == 3 and "damiao_mit:2: its power stage is on" in done.stderr
    assert raw_register("desktop2r", 1, 9) == 0


def test_a_drive_that_forgets_is_found_out(limber, tmp_path):
    path = tmp_path / "motors.yaml"
    with forgetful_drive("forgetful"):
        done = limber("motors", "dump", "virtual:forgetful", "--out", str(path))
        assert done.returncode == 0, done.stderr
        text = path.read_text(encoding="utf-8")
        path.write_text(text.replace(f"{TIMEOUT}: 0", f"{TIMEOUT}: 400"), encoding="utf-8")
        done = limber("motors", "restore", str(path))
    assert done.returncode == 3
    assert f"{TIMEOUT} reads 0 after 400 was written" in done.stderr


def test_two_motors_with_one_number(motors):
    call = motors("desktop2r")
    with forgetful_drive("desktop2r"):
        done = call("dump")
    assert done.returncode == 3 and "two motors answer to damiao_mit:1" in done.stderr


def test_a_dump_of_several_buses_goes_to_the_output(motors):
    call = motors("desktop2r")
    done = call("dump", "virtual:nobody")
    assert done.returncode == 0, done.stderr
    buses = yaml.safe_load(done.stdout)["buses"]
    assert [(bus["bus"], len(bus["motors"])) for bus in buses] == [
        ("virtual:desktop2r", 2),
        ("virtual:nobody", 0),
    ]


def test_nobody_to_dump(limber, tmp_path):
    done = limber("motors", "dump", "virtual:nobody", "--out", str(tmp_path / "none.yaml"))
    assert done.returncode == 3 and "no motor answers" in done.stderr
    assert not (tmp_path / "none.yaml").exists()
