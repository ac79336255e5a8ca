"""Messages for the page, from a running stack or from a log: both look the same to it."""

from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from limber import messages

NUMERIC = (
    "JOINT_STATE",
    "CONTROLLER_STATUS",
    "DRIVER_STATUS",
    "SIM_TRUTH",
    "SCENARIO_EVENT",
    "HAND_STATE",
)
WITH_STRINGS = ("REQUEST_ANSWER", "COMPLIANCE_GAINS", "ROBOT_INFO", "EPISODE_KEPT")
NEVER_S = float("inf")


@dataclass
class Batch:
    """What has arrived since the batch before. `restart`: it does not follow the one before."""

    arrays: dict[str, np.ndarray] = field(default_factory=dict)
    objects: dict[str, list[Any]] = field(default_factory=dict)
    restart: bool = False

    def add(self, later: "Batch") -> None:
        """Puts the arrays of a later batch behind these."""
        if later.restart:
            self.arrays, self.restart = {}, True
        joined = {
            channel: np.concatenate([self.read(channel), rows])
            for channel, rows in later.arrays.items()
        }
        self.arrays = {**self.arrays, **joined}

    def read(self, channel: str) -> np.ndarray:
        """Messages of a fixed-size channel as one structured array, as `Log.read` gives them."""
        found = self.arrays.get(channel)
        return empty(channel) if found is None else found


class Feed(Protocol):
    """`newest`: the last message of each fixed-size channel that had one."""

    newest: dict[str, np.void]

    def take(self) -> Batch: ...

    def age_s(self, channel: str) -> float:
        """Time since the last message; infinite if there was none."""
        ...

    def troubles(self) -> list[str]:
        """What was lost or could not be read."""
        ...

    def close(self) -> None: ...


def empty(channel: str) -> np.ndarray:
    return np.empty(0, messages.native_dtype_of(messages.channels()[channel].type_name))
