"""A converted log holds what the log held, read by the other tools' own libraries."""

import csv
import io
import json
import re
import sys

import numpy as np
import pytest
from made_logs import event_bytes, records, write_log
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
from rich.console import Console

from limber import messages
from limber.cli.main import complaint
from limber.errors import InputError, RunError
from limber.log import event_file
from limber.log.convert import columns, conversion, foxglove_layout, windows
from limber.log.convert.protobuf_layout import UNKNOWN_WORD, Layout
from limber.log.events import Names
from limber.log.reader import Log
from limber.paths import ROOT

COUNT = 40
JOINTS = ("shoulder", "elbow_1")  # as identifiers
ZERO_US = 1_700_000_000_000_000  # when the driver started
FIXED = {"JOINT_STATE": "joint_state_t", "CONTROLLER_STATUS": "controller_status_t"}
FIXED |= {"SIM_TRUTH": "sim_truth_t", "JOINT_TORQUE": "joint_command_t"}


def channel(type_name: str) -> np.ndarray:
    """A different number in every element of every floating-point field."""
    made = records(type_name, COUNT)
    made["time_ns"] = np.arange(COUNT) * 1_000_000
    made["num_joints"] = len(JOINTS)
    number = 0.5
    for name in made.dtype.names:
        if made[name].dtype.kind == "f":
            made[name] = number + np.arange(made[name].size).reshape(made[name].shape)
            number += 1000.0
    return made


def log_bytes() -> list[bytes]:
    """The events of a log with every kind of channel, in order of time."""
    made = []
    for name, type_name in FIXED.items():
        rows = channel(type_name)
        if name == "CONTROLLER_STATUS":
            rows["mode"] = np.where(np.arange(COUNT) < 20, 3, 4)
        stamps = ZERO_US + rows["time_ns"] // 1000
        made += [(stamp, name, row.tobytes()) for stamp, row in zip(stamps, rows, strict=True)]
    info = messages.message_class("robot_info_t")()
    info.num_joints, info.joints, info.robot = 2, ["shoulder", "elbow.1"], "arm"
    answer = messages.message_class("request_answer_t")()
    answer.reason, answer.time_ns = 'too far, "much"', 5_000_000
    made.append((ZERO_US, "ROBOT_INFO", info.encode()))
    made.append((ZERO_US + 5000, "REQUEST_ANSWER", answer.encode()))
    made.append((ZERO_US + 6000, "SOMETHING_ELSE", b"abc"))
    other = bytearray(channel("joint_state_t")[0].tobytes())
    other[3] ^= 1
    made.append((ZERO_US + 7000, "JOINT_STATE", bytes(other)))
    made.sort(key=lambda event: event[0])
    return [event_bytes(name, data, i, int(t)) for i, (t, name, data) in enumerate(made)]


@pytest.fixture
def path(tmp_path):
    made = tmp_path / "run.lcmlog"
    made.write_bytes(b"".join(log_bytes()))
    return made


@pytest.fixture(params=[1 << 25, 20_000], ids=["one window", "many windows"])
def window(request, monkeypatch):
    monkeypatch.setattr(windows, "WINDOW_BYTES", request.param)


def convert(path, to, out=None, channels=()) -> str:
    """Returns what the user is told."""
    console = Console(width=1000, record=True, file=io.StringIO())
    conversion.convert(path, to, out, channels, Names([], []), console)
    return console.export_text()


def mcap_messages(path) -> dict[str, list]:
    """Topic -> (time in ns, message), protobuf as objects, JSON as dictionaries."""
    found = {}
    with open(path, "rb") as file:
        for schema, topic, message in make_reader(file).iter_messages():
            if topic.message_encoding == "json":
                decoded = json.loads(message.data)
            else:
                decoder = DecoderFactory().decoder_for(topic.message_encoding, schema)
                decoded = decoder(message.data)
            found.setdefault(topic.topic, []).append((message.log_time, decoded))
    return found


def at(message, path):
    """What a dotted path leads to."""
    for name in path:
        message = message[name] if isinstance(message, dict) else getattr(message, name)
    return message


def test_mcap_holds_every_number(path, window):
    convert(path, "mcap")
    found = mcap_messages(path.with_suffix(".mcap"))
    for name, type_name in FIXED.items():
        expected, rows = Log(path).read(name), found[f"/{name}"]
        assert [time for time, _ in rows] == [(ZERO_US + i * 1000) * 1000 for i in range(COUNT)]
        for column in columns.columns(type_name, JOINTS):
            values = [at(message, column.path) for _, message in rows]
            wanted = expected[column.field][(slice(None), *column.index)]
            np.testing.assert_array_equal(values, wanted, err_msg=column.name)


def test_mcap_is_in_order_of_time(path, window):
    convert(path, "mcap")
    with open(path.with_suffix(".mcap"), "rb") as file:
        read = make_reader(file).iter_messages(log_time_order=False)
        times = [message.log_time for _, topic, message in read if topic.topic != "/events"]
    assert times == sorted(times)


def test_mcap_has_words_text_story_and_poses(path):
    convert(path, "mcap")
    found = mcap_messages(path.with_suffix(".mcap"))
    _, status = found["/CONTROLLER_STATUS"][30]
    field = status.DESCRIPTOR.fields_by_name["mode"]
    assert field.enum_type.values_by_number[status.mode].name == "MODE_ACTIVE"
    assert found["/REQUEST_ANSWER"][0][1]["reason"] == 'too far, "much"'
    assert found["/ROBOT_INFO"][0][1]["joints"] == ["shoulder", "elbow.1"]
    time_ns, entry = next(e for e in found["/events"] if e[1]["message"] == "mode ACTIVE")
    assert time_ns == (ZERO_US + 20_000) * 1000
    assert entry["timestamp"] == {"sec": 1_700_000_000, "nsec": 20_000_000}
    _, tip = found["/tip"][3]
    expected = Log(path).read("CONTROLLER_STATUS")[3]
    assert list(tip["pose"]["position"].values()) == expected["p_BT"].tolist()
    assert [tip["pose"]["orientation"][axis] for axis in "wxyz"] == expected["quat_BT"].tolist()


def test_every_panel_of_the_layout_finds_its_numbers(path):
    convert(path, "mcap")
    found = mcap_messages(path.with_suffix(".mcap"))
    layout = path.with_suffix(".foxglove.json").read_text()
    wanted = foxglove_layout.paths(layout)
    assert len(wanted) > 20
    for line in wanted:
        topic, *inside = line.split(".")
        at(found[topic][0][1], inside)
    assert set(panels_in(json.loads(layout)["layout"])) == set(json.loads(layout)["configById"])


def panels_in(layout):
    if isinstance(layout, str):
        return [layout]
    return [*panels_in(layout["first"]), *panels_in(layout["second"])]


def test_a_number_that_is_no_word_stays_one():
    rows = records("controller_status_t", 2)
    rows["mode"] = [-3, 4]
    layout = Layout("controller_status_t", columns.columns("controller_status_t", JOINTS))
    sizes = {len(data) for data in layout.encode(rows)}
    assert len(sizes) == 1
    column = next(c for c in columns.columns("controller_status_t", JOINTS) if c.field == "mode")
    start = next(start for known, start, _ in layout._places if known == column)
    assert [data[start] for data in layout.encode(rows)] == [UNKNOWN_WORD, 4]


UNITLESS = ("quat_", "normal.", "law_outputs.", "bus_load_", "damping_ratio", "friction_share")
UNITLESS += ("opening", "heat", "friction", "table_friction", "stiffness_scale")
UNITLESS += ("knots.",)  # of joints, poses or twists, as the message's kind has it


NUMBERS = {row.type_name for row in messages.channels().values()}


@pytest.mark.parametrize("type_name", sorted(filter(messages.dtype_of, NUMBERS)))
def test_every_measured_number_has_a_unit_in_its_name(type_name):
    unit = r"_(m|rad|N|Nm|J|s|A|degC|kg|[A-Za-z]+_per_[A-Za-z_]+)$"
    for column in columns.columns(type_name, JOINTS):
        kind = messages.native_dtype_of(type_name)[column.field].base.kind
        if kind == "f" and not column.name.startswith(UNITLESS):
            assert re.search(unit, column.path[-1]), column.name


def test_csv(path, window):
    convert(path, "csv")
    folder = path.with_name("run_csv")
    table = np.genfromtxt(
        folder / "JOINT_STATE.csv", delimiter=",", names=True, deletechars="", dtype=float
    )
    expected = Log(path).read("JOINT_STATE")
    np.testing.assert_array_equal(table["joints.elbow_1.q_rad"], expected["q"][:, 1])
    np.testing.assert_array_equal(table["F_sensor.mz_Nm"], expected["F_sensor"][:, 5])
    np.testing.assert_array_equal(table["log_time_us"], ZERO_US + np.arange(COUNT) * 1000)
    with open(folder / "REQUEST_ANSWER.csv", newline="") as file:
        assert [row["reason"] for row in csv.DictReader(file)] == ['too far, "much"']
    with open(folder / "events.csv", newline="") as file:
        assert "mode ACTIVE" in {row["what"] for row in csv.DictReader(file)}


def test_parquet(path, window):
    parquet = pytest.importorskip("pyarrow.parquet", reason="comes with ./limber test")
    convert(path, "parquet")
    table = parquet.read_table(path.with_name("run_parquet") / "CONTROLLER_STATUS.parquet")
    expected = Log(path).read("CONTROLLER_STATUS")
    assert table.num_rows == COUNT
    np.testing.assert_array_equal(table["K_x.y_rz_N_per_rad"], expected["K_x"][:, 1, 5])
    np.testing.assert_array_equal(table["joints.shoulder.tau_sent_Nm"], expected["tau_sent"][:, 0])
    events = parquet.read_table(path.with_name("run_parquet") / "events.parquet")
    assert "mode ACTIVE" in events["what"].to_pylist()


def test_rerun(path, window):
    chunk = pytest.importorskip("rerun.chunk", reason="comes with ./limber test")
    convert(path, "rerun")
    numbers, texts = {}, []
    for piece in chunk.RrdReader(path.with_suffix(".rrd")).stream().to_chunks():
        rows = piece.to_record_batch()
        if piece.entity_path == "/JOINT_STATE/joints/elbow_1/q_rad":
            cells = (rows.column(name).to_pylist() for name in ("arm_time", "Scalars:scalars"))
            numbers |= zip(*cells, strict=True)
        if piece.entity_path == "/events":
            texts += [text for (text,) in rows.column("TextLog:text").to_pylist()]
    assert [time.total_seconds() for time in sorted(numbers)] == [i / 1000 for i in range(COUNT)]
    values = [value for _, (value,) in sorted(numbers.items())]
    np.testing.assert_array_equal(values, Log(path).read("JOINT_STATE")["q"][:, 1])
    assert "controller: mode ACTIVE" in texts


def test_lcm_is_the_same_bytes(path, tmp_path):
    convert(path, "lcm", tmp_path / "again.lcmlog")
    assert (tmp_path / "again.lcmlog").read_bytes() == path.read_bytes()


def test_only_some_channels(path, tmp_path):
    convert(path, "lcm", tmp_path / "part.lcmlog", ["JOINT_TORQUE", "SOMETHING_ELSE"])
    assert set(Log(tmp_path / "part.lcmlog").channels) == {"JOINT_TORQUE", "SOMETHING_ELSE"}
    convert(path, "csv", channels=["JOINT_TORQUE"])
    names = {file.name for file in path.with_name("run_csv").iterdir()}
    assert names == {"JOINT_TORQUE.csv", "events.csv"}
    with pytest.raises(InputError, match="JOINT_STATE"):
        convert(path, "mcap", channels=["JOINT_SATE"])


def test_what_is_left_out_is_told(path):
    told = convert(path, "mcap")
    assert "SOMETHING_ELSE: 1 messages left out: not a channel of limber's" in told
    assert "JOINT_STATE: 1 messages left out" in told and "another version" in told
    told = convert(path, "npz")
    assert "REQUEST_ANSWER: 1 messages left out" in told and "text" in told


@pytest.mark.parametrize("to", ["mcap", "csv", "npz"])
def test_of_a_damaged_log_everything_readable_is_converted(path, to):
    """Garbage in the event of JOINT_STATE number 10, and the last event cut off."""
    events = log_bytes()
    hurt = [i for i, data in enumerate(events) if b"JOINT_STATE" in data[:40]][10]
    events[hurt] = events[hurt][:300] + b"\x55" * 77 + events[hurt][300:]
    path.write_bytes(b"".join(events)[:-5])
    whole = {name: len(found) for name, found in Log(path).channels.items()}
    told = convert(path, to, path.with_name("x.npz") if to == "npz" else None)
    assert f"{len(events[hurt])} damaged bytes skipped, the last event is cut off" in told
    if to == "mcap":
        found = mcap_messages(path.with_suffix(".mcap"))
        assert len(found["/JOINT_STATE"]) == COUNT - 1
        assert {name: len(found[f"/{name}"]) for name in FIXED if name != "JOINT_STATE"} == {
            name: whole[name] for name in FIXED if name != "JOINT_STATE"
        }


def test_a_channel_of_another_version_costs_that_channel_only(path):
    rows = channel("joint_state_t")
    rows[messages.FINGERPRINT] += 1
    old = [event_bytes("JOINT_STATE", row.tobytes(), stamp_us=ZERO_US) for row in rows]
    kept = [data for data in log_bytes() if b"JOINT_STATE" not in data[:40]]
    path.write_bytes(b"".join(old + kept))
    told = convert(path, "mcap")
    assert "the story of the run is left out" in told
    assert f"JOINT_STATE: {COUNT} messages left out: not joint_state_t, or of another" in told
    assert len(mcap_messages(path.with_suffix(".mcap"))["/SIM_TRUTH"]) == COUNT


def test_joints_without_names_are_numbered(path):
    path.write_bytes(b"".join(data for data in log_bytes() if b"ROBOT_INFO" not in data[:40]))
    assert windows.joint_names(Log(path), ()) == (("joint1", "joint2"), False)
    assert windows.joint_names(Log(path), ["1st", "a b", "a-b"])[0] == ("joint_1st", "a_b", "a_b_3")


def test_nothing_is_overwritten_and_nothing_half_left(path, monkeypatch):
    convert(path, "mcap")
    before = sorted(path.parent.iterdir())
    with pytest.raises(InputError, match="exists already"):
        convert(path, "mcap")

    def full(*_arguments):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("limber.log.convert.csv_files.CsvFiles.write", full)
    with pytest.raises(RunError, match="No space left"):
        convert(path, "csv")
    assert sorted(path.parent.iterdir()) == before


def test_a_missing_package_is_named_with_the_command(path, monkeypatch):
    monkeypatch.setitem(sys.modules, "rerun", None)
    monkeypatch.delitem(sys.modules, "limber.log.convert.rerun_file", raising=False)
    with pytest.raises(ModuleNotFoundError) as missing:
        convert(path, "rerun")
    assert f"-m pip install -e '{ROOT}[rerun]'" in complaint(missing.value)


def test_events_of_a_file_are_whole(path):
    damage = event_file.Damage()
    found = list(event_file.events(event_file.contents(path, damage), damage))
    assert len(found) == len(log_bytes()) and not str(damage)


CLOSE = ("rot_y", "rotY", "_2", "__2", "a b", "a_b", "a_b_2", "x.y")


def test_names_that_differ_by_little_stay_distinct_in_every_format(tmp_path):
    """protobuf makes one JSON name of rot_y and rotY; other tools want letters, digits and _."""
    n = len(CLOSE)
    state = records("joint_state_t", 50, time_ns=np.arange(50) * 10**6, num_joints=n)
    state["q"][:, :n] = np.arange(50)[:, None] + 100.0 * np.arange(n)
    path = write_log(tmp_path / "run.lcmlog", {"JOINT_STATE": state})
    console = Console(width=1000, record=True, file=io.StringIO())
    for kind in ("mcap", "csv"):
        conversion.convert(path, kind, None, (), Names(list(CLOSE), []), console)
    rows = mcap_messages(path.with_suffix(".mcap"))["/JOINT_STATE"]
    assert len(rows) == 50
    joints = rows[7][1].joints
    named = {name: getattr(joints, name).q_rad for name in joints.DESCRIPTOR.fields_by_name}
    assert sorted(named.values()) == [7 + 100.0 * i for i in range(n)]
    header = (tmp_path / "run_csv" / "JOINT_STATE.csv").read_text().splitlines()[0].split(",")
    positions = [name for name in header if name.startswith("joints.") and name.endswith(".q_rad")]
    assert len(set(positions)) == n
    assert {"joints.rot_y.q_rad", "joints.rotY.q_rad"} < set(positions)
