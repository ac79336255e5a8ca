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
    lockstep: bool | None = None  # None: the scenario's mode
    buses: tuple[str, ...] = ()  # NAME=ADDR, each overrides an address of robot.yaml
    with_simulator: bool = True  # False: an arm, or another simulator, is on the bus
    private_network: bool = False
    live_view: bool = False  # show the arm, not only the progress
    rate_hz: float | None = None  # None: robot.yaml's
    record: bool | None = None  # None: as the scenario says
    record_plain: bool = False  # a plain LCM log instead of a compressed one
    record_can: bool = False  # the frames, too
    page: bool = False  # `limber monitor` beside it

    @property
    def log_name(self) -> str:
        return PLAIN_LOG_NAME if self.record_plain else LOG_NAME


@dataclass
class FinishedRun:
    folder: Path
    mode: str  # lockstep, realtime or lab
    stopped_early: bool = False
    recorded: bool = True
    log_name: str = LOG_NAME
    recorder: dict[str, Any] = field(default_factory=dict)  # the report of limber-record

    @property
    def log(self) -> Path:
        return self.folder / self.log_name

    @property
    def can_log(self) -> Path:
        return self.folder / CAN_LOG_NAME
