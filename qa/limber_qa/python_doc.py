"""The page of `from limber import Arm`, docs/client.md, written from its docstrings."""

import inspect
from collections.abc import Callable

from limber.errors import InputError
from limber.live import arm_errors
from limber.live.arm import Arm
from limber.live.arm_base import ArmBase
from limber.live.arm_modes import Modes
from limber.live.arm_motions import Motions
from limber.live.arm_state import Pose, Quantities, State
from limber.live.arm_streams import Stream, Streams
from limber.live.arm_world import World
from limber.live.episodes import Episodes
from limber.live.hand import Hand, HandState
from limber.live.recording import Recording
from limber.paths import ROOT
from limber_qa.written_table import WrittenTable

CALLS = {
    "Read": ArmBase,
    "Modes": Modes,
    "Motions": Motions,
    "Targets with times": Streams,
    "Compliance, lease": Arm,
    "Hand: `arm.hand`": Hand,
    "Recorded episodes: `arm.episodes`": Episodes,
    "Simulated world": World,
}
OTHERS = (Pose, State, Stream, HandState, Recording)


def _doc(thing: object) -> str:
    """Its docstring; all that this page lists has one."""
    text = inspect.getdoc(thing)
    if text is None:
        raise InputError(f"{thing} has no docstring")
    return text


def _public(owner: type) -> dict[str, object]:
    return {name: value for name, value in vars(owner).items() if not name.startswith("_")}


def _properties(owner: type) -> list[str]:
    rows = [
        f"| `{name}` | {' '.join(_doc(value).split())} |"
        for name, value in _public(owner).items()
        if isinstance(value, property)
    ]
    return ["| property | |", "|---|---|", *rows, ""] if rows else []


def _signature(call: Callable) -> str:
    """Names and defaults; what they are is in the words below."""
    parameters = [
        p.replace(annotation=p.empty) for p in inspect.signature(call).parameters.values()
    ]
    kept = inspect.Signature([p for p in parameters if p.name != "self"])
    return f"{call.__name__}{kept}"


def _calls(owner: type) -> list[str]:
    lines: list[str] = []
    for value in _public(owner).values():
        if inspect.isfunction(value):
            lines += [f"**`{_signature(value)}`**", "", *_doc(value).splitlines(), ""]
    return lines


def _errors() -> list[str]:
    found = [e for e in vars(arm_errors).values() if inspect.isclass(e)]
    own = [error for error in found if error.__module__ == arm_errors.__name__]
    rows = [f"| `{e.__name__}` | {' '.join(_doc(e).split())} |" for e in own]
    return ["### Errors", "", "| error | |", "|---|---|", *rows]


def _lines() -> list[str]:
    lines = ["### Arm", "", *_doc(Arm).splitlines(), ""]
    lines += ["#### Quantities", "", *_doc(Quantities).splitlines(), ""]
    lines += _properties(Quantities)
    for title, owner in CALLS.items():
        lines += [f"#### {title}", "", *_properties(owner), *_calls(owner)]
    for other in OTHERS:
        lines += [f"### {other.__name__}", "", *_doc(other).splitlines(), ""]
        lines += [*_properties(other), *_calls(other)]
    return lines + _errors()


TABLE = WrittenTable(ROOT / "docs" / "client.md", "python", _lines)
