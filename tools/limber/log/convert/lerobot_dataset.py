"""A dataset of LeRobot's, format v3.0, written with pyarrow alone.

Episodes are those that the log's marks tell, with task and success; without marks the times in
ACTIVE of a second or more. A frame has the joints in degrees and the gripper, 0 closed to 100 open;
its action is the target of the next frame's time, where the log has targets of joints
(TARGET_STREAM), else the joints then, and the hand's goal then. Torque and estimated contact stand
beside, where a policy's state is what lerobot-rollout gives it. Times are index / fps, as LeRobot's
are.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow
from pyarrow import parquet

from limber.arrays import Floats
from limber.errors import InputError
from limber.log.convert.windows import Batch
from limber.log.episodes import Episode
from limber.log.events import Event
from limber.messages import message_class

FPS = 30
EVERY_US = 10_000  # of the log a row is kept
SHORTEST_S = 1.0
TASK = "limber"  # where none is named
DONE, SUCCESS = "next.done", "next.success"  # of the last frame
CHUNK = "chunk-000/file-000.parquet"
QUANTILES = (1, 10, 50, 90, 99)
STATE, STATUS, STREAM, HAND = "JOINT_STATE", "CONTROLLER_STATUS", "TARGET_STREAM", "HAND_STATE"


@dataclass
class Samples:
    """Rows of a channel, one a hundredth of a second at most, so that hours fit into memory."""

    stamps_us: list[int] = field(default_factory=list)
    rows: list[Floats] = field(default_factory=list)

    def add(self, stamps_us: np.ndarray, rows: np.ndarray) -> None:
        before_us = self.stamps_us[-1] if self.stamps_us else -EVERY_US
        chosen = np.diff(stamps_us // EVERY_US, prepend=before_us // EVERY_US) > 0
        self.stamps_us += stamps_us[chosen].tolist()
        self.rows += list(rows[chosen])

    def at(self, times_us: np.ndarray) -> Floats:
        """The newest row at each time."""
        where = np.searchsorted(self.stamps_us, times_us, side="right") - 1
        rows: Floats = np.asarray(self.rows)[np.clip(where, 0, None)]
        return rows


class LeRobotDataset:
    """`marked`: the episodes; None: the log has no marks."""

    def __init__(
        self, path: Path, joints: tuple[str, ...], marked: list[Episode] | None = None
    ) -> None:
        self._folder, self._joints = path, joints
        self._marked = marked
        self._tasks = list(dict.fromkeys(_task(one) for one in marked or [])) or [TASK]
        self._state, self._contact, self._mode = Samples(), Samples(), Samples()
        self._hand = Samples()  # opening and goal, of 100; no rows: the arm has none
        self._targets: list[tuple[float, Floats]] = []  # arm time, s
        self._zero_us = 0

    def begin(self, story: Sequence[Event], arm_time_zero_us: int) -> None:
        self._zero_us = arm_time_zero_us

    def write(self, window: list[Batch]) -> None:
        n = len(self._joints)
        for batch in window:
            found = batch.messages
            assert isinstance(found, np.ndarray)
            if batch.channel == STATE:
                rows = np.hstack((found["q"][:, :n], found["tau"][:, :n])).astype(float)
                self._state.add(batch.stamps_us, rows)
            elif batch.channel == STATUS:
                self._contact.add(batch.stamps_us, found["tau_ext"][:, :n].astype(float))
                self._mode.add(batch.stamps_us, found["mode"].astype(float)[:, None])
            elif batch.channel == HAND:
                widths = np.stack((found["width_m"], found["goal_width_m"]), axis=1)
                rows = 100.0 * widths / found["max_width_m"][:, None]
                self._hand.add(batch.stamps_us, np.clip(rows, 0.0, 100.0))
            elif batch.channel == STREAM:
                self._take_targets(batch.stamps_us, found, n)

    def close(self) -> None:
        spans = self._spans()
        if not spans or not self._state.rows or not self._contact.rows:
            why = f"the arm is nowhere in ACTIVE for {SHORTEST_S:g} s"
            if self._marked is not None:
                why = "no mark ends one that is not dropped"
            raise InputError(f"no episode: {why}, or JOINT_STATE or CONTROLLER_STATUS is missing")
        frames = [self._frames(span) for span in spans]
        self._write_data(frames)
        self._write_meta(frames)

    def _take_targets(self, stamps_us: np.ndarray, found: np.ndarray, n: int) -> None:
        """Each message replaces what waits for its first time or later."""
        kinds = message_class("target_stream_t")
        for stamp, message in zip(stamps_us.tolist(), found, strict=True):
            if message["kind"] != kinds.KIND_JOINTS:
                continue
            t0_ns = int(message["t0_ns"])
            start_s = (stamp - self._zero_us) * 1e-6 if t0_ns == kinds.NOW else t0_ns * 1e-9
            count = int(message["num_knots"])
            times_s = start_s + message["dt_s"][:count].astype(float)
            while self._targets and count and self._targets[-1][0] >= times_s[0]:
                self._targets.pop()
            knots = message["value"][:count, :n].astype(float)
            self._targets += zip(times_s.tolist(), knots, strict=True)

    def _spans(self) -> list[tuple[int, int]]:
        """First and last time stamp of each episode."""
        if self._marked is not None:
            return [(one.start_us, one.end_us) for one in self._marked]
        active = message_class("controller_status_t").MODE_ACTIVE
        stamps = np.asarray(self._mode.stamps_us)
        is_active = np.array([int(row[0]) == active for row in self._mode.rows], bool)
        edges = np.flatnonzero(np.diff(is_active.astype(int), prepend=0, append=0))
        spans = [(int(stamps[a]), int(stamps[b - 1])) for a, b in edges.reshape(-1, 2)]
        return [span for span in spans if span[1] - span[0] >= SHORTEST_S * 1e6]

    def _task_numbers(self, lengths: Sequence[int] | np.ndarray) -> list[int]:
        """Of each episode, in the list of tasks."""
        if self._marked is None:
            return [0] * len(lengths)
        return [self._tasks.index(_task(one)) for one in self._marked]

    def _frames(self, span: tuple[int, int]) -> dict[str, Floats]:
        """Columns, a row a frame."""
        n = len(self._joints)
        count = max(int((span[1] - span[0]) * 1e-6 * FPS), 1)
        times_us = span[0] + np.arange(count + 1) * 1e6 / FPS
        state = self._state.at(times_us)
        q = np.degrees(state[:, :n])
        action = q[1:]
        if self._targets:
            at = np.array([time_s for time_s, _ in self._targets])
            knots = np.degrees(np.array([knot for _, knot in self._targets]))
            then_s = (times_us[1:] - self._zero_us) * 1e-6
            aimed = np.stack([np.interp(then_s, at, column) for column in knots.T], axis=1)
            known = (then_s >= at[0]) & (then_s <= at[-1] + 1.0)
            action = np.where(known[:, None], aimed, action)
        if self._hand.rows:
            hand = self._hand.at(times_us)
            q, action = np.hstack((q, hand[:, :1])), np.hstack((action, hand[1:, 1:]))
        found = {"observation.state": q, "torque": state[:, n:]}
        found["contact"] = self._contact.at(times_us)
        return {**{key: rows[:count] for key, rows in found.items()}, "action": action}

    def _features(self) -> dict[str, Any]:
        joints = [f"joint_{i + 1}" for i in range(len(self._joints))]
        positions = [f"{joint}.pos" for joint in joints]
        positions += ["gripper.pos"] if self._hand.rows else []
        names = {
            "observation.state": positions,
            **{group: [f"{joint}.{group}" for joint in joints] for group in ("torque", "contact")},
            "action": positions,
        }
        own = {
            key: {"dtype": "float32", "shape": [len(words)], "names": words}
            for key, words in names.items()
        }
        ends = (DONE, SUCCESS) if self._marked is not None else ()
        indices = ("frame_index", "episode_index", "index", "task_index")
        return {
            **own,
            "timestamp": {"dtype": "float32", "shape": [1], "names": None},
            **{key: {"dtype": "bool", "shape": [1], "names": None} for key in ends},
            **{key: {"dtype": "int64", "shape": [1], "names": None} for key in indices},
        }

    def _write_data(self, frames: list[dict[str, Floats]]) -> None:
        lengths = [len(one["action"]) for one in frames]
        within = np.concatenate([np.arange(length) for length in lengths])
        columns = {
            **{key: _lists(rows) for key, rows in _joined(frames).items()},
            "timestamp": pyarrow.array((within / FPS).astype(np.float32)),
            "frame_index": pyarrow.array(within),
            "episode_index": pyarrow.array(np.repeat(np.arange(len(lengths)), lengths)),
            "index": pyarrow.array(np.arange(sum(lengths))),
            "task_index": pyarrow.array(np.repeat(self._task_numbers(lengths), lengths)),
        }
        if self._marked is not None:
            last = np.cumsum(lengths) - 1
            done = np.isin(np.arange(sum(lengths)), last)
            good = np.repeat([one.outcome == "success" for one in self._marked], lengths)
            columns |= {DONE: pyarrow.array(done), SUCCESS: pyarrow.array(done & good)}
        self._parquet(f"data/{CHUNK}", pyarrow.table(columns))

    def _write_meta(self, frames: list[dict[str, Floats]]) -> None:
        lengths = np.array([len(one["action"]) for one in frames])
        ends = np.cumsum(lengths)
        zeros = np.zeros(len(lengths), np.int64)
        episodes = {
            "episode_index": np.arange(len(lengths)),
            "tasks": [[self._tasks[number]] for number in self._task_numbers(lengths)],
            "length": lengths,
            "data/chunk_index": zeros,
            "data/file_index": zeros,
            "dataset_from_index": ends - lengths,
            "dataset_to_index": ends,
            "meta/episodes/chunk_index": zeros,
            "meta/episodes/file_index": zeros,
        }
        if self._marked is not None:
            episodes["success"] = [one.outcome == "success" for one in self._marked]
        self._parquet(f"meta/episodes/{CHUNK}", pyarrow.table(episodes))
        # The task is pandas' index: without this note it would be read as a number.
        tasks = pyarrow.table({"task_index": np.arange(len(self._tasks)), "task": self._tasks})
        note = {"index_columns": ["task"], "column_indexes": [], "columns": _pandas_columns()}
        noted = tasks.replace_schema_metadata({"pandas": json.dumps(note)})
        self._parquet("meta/tasks.parquet", noted)
        total = int(lengths.sum())
        info = {
            "codebase_version": "v3.0",
            "robot_type": "limber_follower",
            "total_episodes": len(lengths),
            "total_frames": total,
            "total_tasks": len(self._tasks),
            "chunks_size": 1000,
            "data_files_size_in_mb": 100,
            "video_files_size_in_mb": 200,
            "fps": FPS,
            "splits": {"train": f"0:{len(lengths)}"},
            "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
            "video_path": None,
            "features": self._features(),
        }
        self._json("meta/info.json", info)
        stats = {key: _stats(rows) for key, rows in _joined(frames).items()}
        self._json("meta/stats.json", stats)

    def _parquet(self, name: str, table: pyarrow.Table) -> None:
        path = self._folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        parquet.write_table(table, path)

    def _json(self, name: str, content: dict[str, Any]) -> None:
        text = json.dumps(content, indent=4) + "\n"
        (self._folder / name).write_text(text, encoding="utf-8")


def _joined(frames: list[dict[str, Floats]]) -> dict[str, Floats]:
    return {key: np.concatenate([one[key] for one in frames]) for key in frames[0]}


def _task(episode: Episode) -> str:
    return episode.task or TASK


def _pandas_columns() -> list[dict[str, Any]]:
    kinds = {"task_index": ("int64", "int64"), "task": ("unicode", "object")}
    return [
        {
            "name": name,
            "field_name": name,
            "pandas_type": kind,
            "numpy_type": numpy,
            "metadata": None,
        }
        for name, (kind, numpy) in kinds.items()
    ]


def _lists(rows: Floats) -> pyarrow.Array:
    flat = pyarrow.array(np.ascontiguousarray(rows, np.float32).ravel())
    return pyarrow.FixedSizeListArray.from_arrays(flat, rows.shape[1])


def _stats(rows: Floats) -> dict[str, list[float]]:
    found = {
        "min": rows.min(axis=0),
        "max": rows.max(axis=0),
        "mean": rows.mean(axis=0),
        "std": rows.std(axis=0),
        "count": np.array([len(rows)]),
    }
    for q in QUANTILES:
        found[f"q{q:02d}"] = np.percentile(rows, q, axis=0)
    return {name: values.tolist() for name, values in found.items()}
