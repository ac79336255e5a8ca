"""A dataset of LeRobot's from a log: episodes, frames, units and actions, read file by file."""

import json

import numpy as np
import pytest
from made_logs import event_bytes, records
from rich.console import Console

from limber.errors import InputError
from limber.log.convert import conversion
from limber.log.events import Names
from limber.messages import message_class

parquet = pytest.importorskip("pyarrow.parquet", reason="comes with ./limber test")
ACTIVE, HOLD, FPS = 4, 3, 30
JOINTS = 2
NAMES = Names(["shoulder", "elbow"], [])


def events(active_s, stream=(), marks=(), hand=()):
    """Four seconds: q = 0.1 t and 0.2 t, torque 1 and 2, contact 3 and 4; ACTIVE in `active_s`."""
    state, status = records("joint_state_t", 4000), records("controller_status_t", 800)
    t, status_t = np.arange(4000) * 1e-3, np.arange(800) * 5e-3
    for rows, at in ((state, t), (status, status_t)):
        rows["time_ns"] = np.round(at * 1e9)
        rows["num_joints"] = JOINTS
    state["q"][:, :2] = t[:, None] * [0.1, 0.2]
    state["tau"][:, :2] = [1, 2]
    status["tau_ext"][:, :2] = [3, 4]
    status["mode"] = HOLD
    for begin, end in active_s:
        status["mode"][(status_t >= begin) & (status_t < end)] = ACTIVE
    made = [
        (int(row["time_ns"]) // 1000, name, row.tobytes())
        for name, rows in (("JOINT_STATE", state), ("CONTROLLER_STATUS", status))
        for row in rows
    ]
    made += [(int(at * 1e6), "TARGET_STREAM", message.encode()) for at, message in stream]
    made += [(int(at * 1e6), "EPISODE", message.encode()) for at, message in marks]
    made += [(int(at * 1e6), "HAND_STATE", message.encode()) for at, message in hand]
    made.sort(key=lambda event: event[0])
    return [event_bytes(name, data, i, at) for i, (at, name, data) in enumerate(made)]


def converted(tmp_path, active_s, stream=(), marks=(), hand=()):
    log = tmp_path / "run.lcmlog"
    log.write_bytes(b"".join(events(active_s, stream, marks, hand)))
    out = tmp_path / "dataset"
    conversion.convert(log, "lerobot", out, (), NAMES, Console(quiet=True))
    data = parquet.read_table(out / "data/chunk-000/file-000.parquet").to_pydict()
    return out, {name: np.array(values) for name, values in data.items()}


def targets(t0_s, times_s, joints):
    message = message_class("target_stream_t")()
    message.t0_ns, message.num_joints = round(t0_s * 1e9), JOINTS
    message.num_knots = len(times_s)
    message.dt_s[: len(times_s)] = times_s
    for row, knot in zip(message.value, joints, strict=False):
        row[:JOINTS] = knot
    return t0_s, message


def test_every_time_in_active_is_an_episode(tmp_path):
    out, data = converted(tmp_path, [(0.5, 1.6), (1.8, 2.0), (2.5, 4.0)])  # 0.2 s is none
    info = json.loads((out / "meta/info.json").read_text())
    assert (info["total_episodes"], info["fps"], info["codebase_version"]) == (2, FPS, "v3.0")
    episodes = parquet.read_table(out / "meta/episodes/chunk-000/file-000.parquet").to_pydict()
    assert sum(episodes["length"]) == info["total_frames"] == len(data["index"])
    first = episodes["length"][0]
    assert episodes["dataset_from_index"] == [0, first]
    assert data["episode_index"].tolist() == [0] * first + [1] * episodes["length"][1]
    np.testing.assert_allclose(data["timestamp"][:first], np.arange(first) / FPS, atol=1e-6)


def test_frames_are_degrees_torque_and_contact_and_the_action_is_the_next_frame(tmp_path):
    _, data = converted(tmp_path, [(0.5, 3.5)])
    t = 0.5 + data["frame_index"] / FPS
    state = data["observation.state"]
    np.testing.assert_allclose(state[:, 0], np.degrees(0.1 * t), atol=np.degrees(0.1) * 0.011)
    assert state.shape[1] == 2
    np.testing.assert_allclose(data["torque"], np.tile([1, 2], (len(t), 1)))
    np.testing.assert_allclose(data["contact"], np.tile([3, 4], (len(t), 1)))
    np.testing.assert_allclose(data["action"][:-1], state[1:, :2], atol=1e-4)


def hand_state(at_s, width_m, goal_m):
    message = message_class("hand_state_t")()
    message.time_ns = round(at_s * 1e9)
    message.width_m, message.goal_width_m, message.max_width_m = width_m, goal_m, 0.08
    return at_s, message


def test_the_gripper_is_of_100_and_its_action_the_goal(tmp_path):
    """Half open; from 2 s on told to press something thin, 0.02 m beyond closed."""
    hand = [hand_state(t, 0.04, 0.06 if t < 2.0 else -0.02) for t in np.arange(400) / 100]
    out, data = converted(tmp_path, [(0.5, 3.5)], hand=hand)
    then = 0.5 + (data["frame_index"] + 1) / FPS
    np.testing.assert_allclose(data["observation.state"][:, 2], 50)
    np.testing.assert_allclose(data["action"][:, 2], np.where(then < 2.0, 75, 0))
    features = json.loads((out / "meta/info.json").read_text())["features"]
    assert features["action"]["names"] == ["joint_1.pos", "joint_2.pos", "gripper.pos"]
    assert features["observation.state"]["names"] == features["action"]["names"]


def test_targets_of_a_stream_are_the_actions(tmp_path):
    """The second message replaces what the first one had for 1.5 s and later."""
    times = np.arange(16) / 10
    stream = [
        targets(1.0, times, np.tile([[1.0, 2.0]], (16, 1))),
        targets(1.5, times, np.tile([[3.0, 4.0]], (16, 1))),
    ]
    _, data = converted(tmp_path, [(0.5, 3.5)], stream)
    then = 0.5 + (data["frame_index"] + 1) / FPS
    early, late = (then > 1.0) & (then < 1.4), (then > 1.5) & (then < 3.0)
    np.testing.assert_allclose(data["action"][early], np.degrees([[1, 2]] * early.sum()), rtol=1e-5)
    np.testing.assert_allclose(data["action"][late], np.degrees([[3, 4]] * late.sum()), rtol=1e-5)
    before = data["observation.state"][1:, 0][then[:-1] < 1.0]
    np.testing.assert_allclose(data["action"][:-1, 0][then[:-1] < 1.0], before, atol=1e-4)


def test_a_log_without_an_episode_is_told(tmp_path):
    with pytest.raises(InputError, match="nowhere in ACTIVE"):
        converted(tmp_path, [])
    assert not (tmp_path / "dataset").exists()


def mark(at_s, kind, task=""):
    message = message_class("episode_mark_t")()
    message.seq, message.mark, message.task = round(1e9 * at_s), kind, task
    return at_s, message


def test_marks_are_the_episodes_with_task_and_success(tmp_path):
    """Whatever the mode is; the dropped one and the one without an end are none."""
    kinds = message_class("episode_mark_t")
    marks = [
        mark(0.2, kinds.MARK_START, "pick"),
        mark(1.2, kinds.MARK_SUCCESS),
        mark(1.5, kinds.MARK_START, "pick"),
        mark(1.8, kinds.MARK_FAILURE),
        mark(1.9, kinds.MARK_DROP),
        mark(2.0, kinds.MARK_START, "place"),
        mark(3.0, kinds.MARK_FAILURE),
        mark(3.2, kinds.MARK_START, "pick"),
        mark(3.5, kinds.MARK_SUCCESS),
        mark(3.8, kinds.MARK_START, "never"),
    ]
    out, data = converted(tmp_path, [(0.5, 3.5)], marks=marks)
    info = json.loads((out / "meta/info.json").read_text())
    found = parquet.read_table(out / "meta/episodes/chunk-000/file-000.parquet").to_pydict()
    assert (info["total_episodes"], info["total_tasks"]) == (3, 2)
    assert found["length"] == [30, 30, 9]
    assert found["tasks"] == [["pick"], ["place"], ["pick"]]
    assert found["success"] == [True, False, True]
    tasks = parquet.read_table(out / "meta/tasks.parquet").to_pydict()
    assert tasks == {"task_index": [0, 1], "task": ["pick", "place"]}
    assert data["task_index"].tolist() == [0] * 30 + [1] * 30 + [0] * 9
    assert np.flatnonzero(data["next.done"]).tolist() == [29, 59, 68]
    assert np.flatnonzero(data["next.success"]).tolist() == [29, 68]
    t = np.array([0.2, 2.0, 3.2])[data["episode_index"]] + data["frame_index"] / FPS
    shoulder = data["observation.state"][:, 0]
    np.testing.assert_allclose(shoulder, np.degrees(0.1 * t), atol=np.degrees(0.1) * 0.011)
    assert info["features"]["next.success"] == {"dtype": "bool", "shape": [1], "names": None}


def test_without_marks_nothing_is_said_of_success(tmp_path):
    out, data = converted(tmp_path, [(0.5, 3.5)])
    assert "next.success" not in data
    assert "next.success" not in json.loads((out / "meta/info.json").read_text())["features"]


def test_marks_without_an_episode_are_told(tmp_path):
    """They stand before what the mode would make of it."""
    start = mark(0.6, message_class("episode_mark_t").MARK_START)
    with pytest.raises(InputError, match="no mark ends one"):
        converted(tmp_path, [(0.5, 3.5)], marks=[start])
