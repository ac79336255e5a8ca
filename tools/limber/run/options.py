"""How a scenario is run, and what a run leaves."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

LOG_NAME = "run.lcmlog.zst"  # limber-record compresses what ends so
PLAIN_LOG_NAME = "run.lcmlog"
CAN_LOG_NAME = "run.can.log"


@dataclass(frozen=True)
class RunOptions:
    out: Path | None = None  # folder for the results; None: out/NAME-<n>
    lockstep: bool | None = None  # or real time; None: see pace.choose()
    one_process: bool = False  # driver, controller and simulator in one
    buses: tuple[str, ...] = ()  # NAME=ADDR, each overrides an address of robot.yaml
    with_simulator: bool = True  # False: an arm, or another simulator, is on the bus
    private_network: bool = False
    live_view: bool = False  # show the arm, not only the progress
    rate_hz: float | None = None  # None: robot.yaml's
    record: bool | None = None  # None: as the scenario says
    record_plain: bool = False  # a plain LCM log instead of a compressed one
    record_can: bool = False  # the frames, too
    page: bool = False  # `limber monitor` beside it
    leave_when_behind: bool = False  # end a paced run that the machine does not keep up with
    robot: str | None = None  # name or folder; None: the scenario's

    @property
    def log_name(self) -> str:
        return PLAIN_LOG_NAME if self.record_plain else LOG_NAME


@dataclass
class FinishedRun:
    folder: Path
    mode: str  # lockstep, paced, realtime or lab
    stopped_early: bool = False
    behind: str = ""  # it was left since the machine did not keep up: the program's words
    recorded: bool = True
    log_name: str = LOG_NAME
    recorder: dict[str, Any] = field(default_factory=dict)  # the report of limber-record

    @property
    def log(self) -> Path:
        return self.folder / self.log_name

    @property
    def can_log(self) -> Path:
        return self.folder / CAN_LOG_NAME
