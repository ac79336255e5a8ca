"""A lab in this process: driver, controller and simulated arm in lock step, as fast as the
processor allows, without network, threads or Python's lock (lab/lab_interface.h).

    lab = Lab({"robot": "openarm"})
    lab.step(1000)
    lab.message("JOINT_STATE")["q"]

Labs share nothing: one a thread, as many as there are cores. Equal scenarios, and equal messages
between equal steps, give equal bytes.
"""

import ctypes
import itertools
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from limber.errors import InputError, LimberError, RunError
from limber.messages import SCENARIO_CLIENT, channels, view
from limber.paths import REPAIR, private_library, programs_folder, scenario_file

FORMAT = "limber-scenario/1"
IN_MEMORY = "scenario"  # what stands for the file in errors
LONGEST_S = 3600.0  # of a scenario that names no duration
WHOLE = "liblimber.so.0"  # of this major version
_LOCKSTEP_RUN = 1  # common/run_id.h
_LARGEST = 1400  # bytes of a message
_REFUSED, _MALFORMED, _CHANNEL, _NONE = -1, -2, -3, -4


class RefusedByLabError(LimberError):
    """Controller or simulator did not take the message; nothing has changed."""


class Lab:
    """A simulated arm at the start of a scenario.

    `scenario`: a file; YAML; or a mapping with a scenario's keys, of which `robot` is the only one
    needed. Its timeline enables the arm by itself unless it names a mode. InputError names file,
    line, key and what is allowed. One thread at a time may call it.
    """

    def __init__(self, scenario: str | Path | Mapping[str, Any]) -> None:
        self._lab: int | None = None
        text, name = _text_of(scenario)
        problem = ctypes.create_string_buffer(4000)
        library = _library()
        self._lab = library.limber_lab_open(text.encode(), name.encode(), problem, len(problem))
        if self._lab is None:
            raise InputError(problem.value.decode(errors="replace"))
        self.period_s: float = 1e-9 * library.limber_lab_period_ns(self._lab)
        self._room = ctypes.create_string_buffer(_LARGEST)
        self._seq = itertools.count(1)

    @property
    def time_ns(self) -> int:
        """Arm time of the next cycle, ns."""
        time_ns: int = _library().limber_lab_time_ns(self._open())
        return time_ns

    def step(self, cycles: int = 1) -> None:
        """So many control cycles, without Python's lock."""
        if cycles < 0:
            raise InputError(f"cycles: {cycles} is less than 0")
        _library().limber_lab_step(self._open(), cycles)

    def send(self, message: Any) -> None:
        """A request such as mode_request_t, compliance_goal_t, compliance_gains_t,
        target_stream_t, hand_goal_t, push_t, scenario_event_t or workpiece_t; it acts from the next
        cycle on. Number, time, sender and run of the controller are filled in. RefusedByLabError
        with the reason.
        """
        channel = _channel_of(type(message).__name__)
        message.seq, message.time_ns = next(self._seq), self.time_ns
        if hasattr(message, "client"):
            message.client, message.controller = SCENARIO_CLIENT, _LOCKSTEP_RUN
        self.send_bytes(channel, message.encode())

    def send_bytes(self, channel: str, data: bytes) -> None:
        """The same of an encoded message, as it is."""
        self._check(
            _library().limber_lab_send(self._open(), channel.encode(), data, len(data)), channel
        )

    def message(self, channel: str) -> np.void:
        """Newest message of a channel of fixed size, by field: JOINT_STATE, JOINT_TORQUE,
        CONTROLLER_STATUS, DRIVER_STATUS, SIM_TRUTH, BLOCK_TRUTH, HAND_STATE, HAND_TRUTH. SI units,
        as in lcmtypes/.
        """
        data = self.message_bytes(channel)
        return view(channels()[channel].type_name, data)

    def message_bytes(self, channel: str) -> bytes:
        """The same, encoded; also of ROBOT_INFO and REQUEST_ANSWER."""
        size = _library().limber_lab_message(
            self._open(), channel.encode(), self._room, len(self._room)
        )
        self._check(size, channel)
        return self._room.raw[:size]

    def close(self) -> None:
        if self._lab is not None:
            _library().limber_lab_close(self._lab)
            self._lab = None

    def __enter__(self) -> "Lab":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        self.close()

    def _open(self) -> int:
        if self._lab is None:
            raise RunError("the lab is closed")
        return self._lab

    def _check(self, code: int, channel: str) -> None:
        if code >= 0:
            return
        text = _library().limber_lab_error(self._lab).decode(errors="replace")
        if code == _REFUSED:
            raise RefusedByLabError(f"{channel} refused: {text}")
        if code in (_MALFORMED, _CHANNEL, _NONE):
            raise InputError(text)
        raise RunError(text)


def _text_of(scenario: str | Path | Mapping[str, Any]) -> tuple[str, str]:
    """YAML, and what stands for its file."""
    if isinstance(scenario, Mapping):
        whole = {"format": FORMAT, "duration_s": LONGEST_S, **scenario}
        return yaml.safe_dump(whole, sort_keys=False), IN_MEMORY
    if isinstance(scenario, str) and "\n" in scenario:
        return scenario, IN_MEMORY
    path = scenario_file(Path(scenario))
    return path.read_text(encoding="utf-8"), str(path)


@cache
def _channel_of(type_name: str) -> str:
    for name, channel in channels().items():
        if channel.type_name == type_name and channel.sender == "user":
            return name
    raise InputError(f"{type_name} is no request")


@cache
def _library() -> Any:
    """A clone has the lab by itself; a package all of limber in one, or the system's loader has."""
    places = (private_library("liblimber_lab.so"), programs_folder().parent / "lib" / WHOLE)
    path = next((str(place) for place in places if place.exists()), WHOLE)
    try:
        library = ctypes.CDLL(path)
    except OSError as error:
        raise RunError(f"{path} cannot be loaded: {REPAIR} ({error})") from error
    handle, text, size = ctypes.c_void_p, ctypes.c_char_p, ctypes.c_size_t
    signatures: dict[str, tuple[Any, list[Any]]] = {
        "open": (handle, [text, text, text, size]),
        "close": (None, [handle]),
        "step": (None, [handle, ctypes.c_int64]),
        "send": (ctypes.c_int, [handle, text, text, size]),
        "message": (ctypes.c_int, [handle, text, text, size]),
        "time_ns": (ctypes.c_int64, [handle]),
        "period_ns": (ctypes.c_int64, [handle]),
        "error": (text, [handle]),
    }
    for name, (result, arguments) in signatures.items():
        function = getattr(library, f"limber_lab_{name}")
        function.restype, function.argtypes = result, arguments
    return library


__all__ = ["Lab", "RefusedByLabError"]
