"""A recording for Rerun: a scalar a number, the story of the run as text."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import rerun
import rerun.blueprint as layout

from limber.log.convert.csv_files import STAMP, flat
from limber.log.convert.windows import Batch
from limber.log.events import Event

TIMELINE = "arm_time"


class RerunFile:
    def __init__(self, path: Path, joints: tuple[str, ...]) -> None:
        self._joints = joints
        self._zero_us = 0
        self._recording = rerun.RecordingStream("limber", make_default=False)
        self._recording.save(path, default_blueprint=_blueprint(joints))

    def begin(self, story: Sequence[Event], arm_time_zero_us: int) -> None:
        self._zero_us = arm_time_zero_us
        for event in story:
            time = np.timedelta64(round(event.time_s * 1e6), "us")
            self._recording.set_time(TIMELINE, duration=time)
            level = rerun.TextLogLevel.ERROR if event.bad else rerun.TextLogLevel.INFO
            self._recording.log("events", rerun.TextLog(f"{event.who}: {event.text}", level=level))

    def write(self, window: list[Batch]) -> None:
        for batch in window:
            table = flat(batch, self._joints)
            stamps = table.pop(STAMP)
            time = rerun.TimeColumn(TIMELINE, duration=(stamps - self._zero_us).astype("m8[us]"))
            for name, values in table.items():
                scalars = rerun.Scalars.columns(scalars=np.asarray(values, float))
                path = f"{batch.channel}/{name.replace('.', '/')}"
                self._recording.send_columns(path, indexes=[time], columns=scalars)

    def close(self) -> None:
        self._recording.flush()
        self._recording.disconnect()


def _blueprint(joints: tuple[str, ...]) -> layout.Blueprint:
    def joint_plot(title: str, number: str) -> layout.TimeSeriesView:
        contents = [f"/JOINT_STATE/joints/{joint}/{number}" for joint in joints]
        return layout.TimeSeriesView(name=title, origin="/", contents=contents)

    return layout.Blueprint(
        layout.Vertical(
            joint_plot("joint position, rad", "q_rad"),
            joint_plot("joint torque, N m", "tau_Nm"),
            layout.TimeSeriesView(name="tip minus goal, m and rad", origin="/CONTROLLER_STATUS/e"),
            layout.TextLogView(name="events", origin="/events"),
        )
    )
