"""limber's Python side: the running arm in a script, command line, runs, logs and plots.

`from limber import Arm` is loaded when it is used, and so are its Pose, State and errors.
"""

from importlib import import_module
from typing import Any

_FROM = {
    "Arm": "limber.live.arm",
    "Pose": "limber.live.arm_state",
    "State": "limber.live.arm_state",
    "LimberError": "limber.errors",
    "InputError": "limber.errors",
    "NoStackError": "limber.live.arm_errors",
    "StackLostError": "limber.live.arm_errors",
    "RefusedError": "limber.live.arm_errors",
    "FaultError": "limber.live.arm_errors",
    "RecoveryError": "limber.live.arm_errors",
    "NotReachedError": "limber.live.arm_errors",
    "WaitTimeoutError": "limber.live.arm_errors",
}
__all__ = ["__version__", *_FROM]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib import metadata  # takes longer to load than all else here

        return metadata.version("limber-arm")  # of pyproject.toml
    if name not in _FROM:
        raise AttributeError(f"module 'limber' has no attribute {name!r}")
    return getattr(import_module(_FROM[name]), name)
