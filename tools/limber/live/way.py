"""The controller's modes, the requests that each takes, and the way from one to another."""

from typing import Any

from limber.messages import constants

WAY = ("acknowledge", "hold", "active")
"""Requests from FAULT to ACTIVE, in their order."""

LEADS_TO = {"acknowledge": "IDLE", "hold": "HOLD", "active": "ACTIVE", "idle": "IDLE"}

TAKES: dict[str, tuple[str, ...]] = {
    "BOOT": (),
    "INIT": (),
    "IDLE": ("hold",),
    "HOLD": ("active", "idle"),
    "ACTIVE": ("hold",),
    "SOFT_STOP": (),
    "FAULT": ("acknowledge",),
    "ESTOP": ("acknowledge",),
}
"""Requests that change the mode, by mode (controller/modes/mode_table.cc); stop is taken in all."""

NEEDS = {"goal": "active"}  # requests of other kinds


def way_from(mode: str, wanted: str) -> list[str]:
    """The fewest requests from a mode whose last is `wanted`; none if there is no such way, as from
    BOOT, INIT and SOFT_STOP, which end by themselves.
    """
    ways: list[tuple[str, list[str]]] = [(mode, [])]
    seen = {mode}
    for at, way in ways:  # grows: breadth first
        for request in TAKES.get(at, ()):
            if request == wanted:
                return [*way, request]
            if LEADS_TO[request] not in seen:
                seen.add(LEADS_TO[request])
                ways.append((LEADS_TO[request], [*way, request]))
    return []


def in_words(mode: str, wanted: str) -> str:
    """Why a request was refused in a mode, and what leads to it: a clause."""
    refused = f"{wanted} is not taken in {mode.replace('_', ' ')}"
    way = way_from(mode, NEEDS.get(wanted, wanted))
    if mode in ("BOOT", "INIT"):
        return f"{refused}: the controller waits for good states of the arm"
    if mode == "SOFT_STOP":
        return f"{refused}: the arm comes to rest and is then in HOLD"
    if way == [wanted]:
        return f"{refused} yet: the drives are not on"
    return f"{refused}; the way there: {', '.join(way)}" if way else f"{refused}: nothing to do"


def in_words_of(answer: Any, mode: str) -> str:
    """The same of an answer with REFUSED_MODE."""
    kind = constants("request_answer_t", "KIND_")[answer.kind].lower()
    if kind == "mode":
        kind = constants("mode_request_t", "REQUEST_").get(answer.what, kind).lower()
    return in_words(mode, kind)
