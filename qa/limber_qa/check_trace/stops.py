"""Rules over the whole arm: how soon it stops after a fault, and that it stays stopped."""

from collections.abc import Iterator
from dataclasses import dataclass

from limber_qa.check_trace.events import Command, Kind
from limber_qa.check_trace.rules import Breach, Track

FAILED_CYCLES = 3  # from a drive's report to the first safe frame
SILENT_CYCLES = 5  # from the first reply that is missing


@dataclass(frozen=True)
class Expectation:
    """What is known beside the trace; times as in the trace.

    `fault_ns`: a fault begins here, and every drive has its first safe frame `stop_ns` later at
    most. `latched`: nobody acknowledges, so that no drive follows again after a fault.
    `silent_cycles`: replies may be missing for so long.
    """

    fault_ns: int | None = None
    stop_ns: int | None = None
    latched: bool = False
    silent_cycles: int = SILENT_CYCLES


@dataclass(frozen=True)
class Fault:
    """What the trace itself shows. `stop_ns`: time of the last frame that may follow."""

    time_ns: int
    stop_ns: int
    joint: str
    text: str


def stop_time_ns(track: Track, fault_ns: int) -> int | None:
    """From the fault to the first safe frame; None if there is none, or it cannot be told."""
    for command in track.commands:
        if command.time_ns >= fault_ns and command.kind.stops:
            return command.time_ns - fault_ns
    return None


def told_stops(tracks: list[Track], expected: Expectation) -> Iterator[Breach]:
    """A fault that the caller knows of. A drive that gets no frame any more is its own watchdog's
    business.
    """
    if expected.fault_ns is None or expected.stop_ns is None:
        return
    for track in tracks:
        after = [command for command in track.commands if command.time_ns >= expected.fault_ns]
        if not track.tells_hold or not after:
            continue
        taken = stop_time_ns(track, expected.fault_ns)
        # The frames of a cycle are spread over it.
        if taken is None or taken >= expected.stop_ns + track.period_ns // 2:
            end = after[-1].time_ns - expected.fault_ns if taken is None else taken
            yield Breach(
                expected.fault_ns,
                track.motor.name,
                "stop",
                end * 1e-6,
                expected.stop_ns * 1e-6,
                "ms",
                "to the first safe frame" if taken is not None else "without a safe frame",
            )


def seen_faults(tracks: list[Track], expected: Expectation) -> list[Fault]:
    """Drives that fail or fall silent while they follow; the first of each."""
    found = []
    for track in tracks:
        for fault in (_failed(track), _silent(track, expected.silent_cycles)):
            if fault is not None:
                found.append(fault)
    return sorted(found, key=lambda fault: fault.time_ns)


def _failed(track: Track) -> Fault | None:
    enabled = False
    for state in track.states:
        if enabled and state.failed:
            stop_ns = state.time_ns + FAILED_CYCLES * track.period_ns
            return Fault(state.time_ns, stop_ns, track.motor.name, "the drive reports an error")
        enabled = state.enabled
    return None


def _silent(track: Track, cycles: int) -> Fault | None:
    """More commands in a row without a state than may be bridged. A driver that pauses itself
    makes no drive silent.
    """
    unanswered = 0
    for number, command in enumerate(track.commands):
        answered = number == 0 or track.seen[number] > track.seen[number - 1]
        unanswered = 0 if answered else unanswered + 1
        last = track.last(number, 1)
        if command.kind is Kind.FOLLOW and unanswered > cycles and last and last[0].enabled:
            text = "the drive is silent"
            return Fault(last[0].time_ns, command.time_ns, track.motor.name, text)
    return None


def seen_stops(tracks: list[Track], expected: Expectation) -> Iterator[Breach]:
    """After a fault in the trace no drive follows on; the first frame of each drive is named."""
    for fault in seen_faults(tracks, expected):
        for track in tracks:
            late = _first_follower(track, fault.stop_ns, fault)
            if late is not None:
                yield Breach(
                    late.time_ns,
                    track.motor.name,
                    "stop",
                    (late.time_ns - fault.time_ns) * 1e-6,
                    (fault.stop_ns - fault.time_ns) * 1e-6,
                    "ms",
                    f"follows on after a fault of {fault.joint}: {fault.text}",
                )


def _first_follower(track: Track, from_ns: int, fault: Fault) -> Command | None:
    """A frame that follows without any stop since the fault."""
    if not track.tells_hold:
        return None
    for command in track.commands:
        if command.time_ns < fault.time_ns:
            continue
        if command.kind.stops:
            return None
        if command.time_ns > from_ns and command.kind is Kind.FOLLOW:
            return command
    return None


def stays_stopped(tracks: list[Track], expected: Expectation) -> Iterator[Breach]:
    """Nobody acknowledged: after the first stop no drive is enabled or follows again."""
    if not expected.latched:
        return
    begins = [fault.time_ns for fault in seen_faults(tracks, expected)]
    if expected.fault_ns is not None:
        begins.append(expected.fault_ns)
    if not begins:
        return
    for track in tracks:
        stopped = False
        for command in track.commands:
            if command.time_ns < min(begins):
                continue
            stopped = stopped or command.kind.stops
            if stopped and command.kind in (Kind.ENABLE, Kind.FOLLOW):
                yield Breach(
                    command.time_ns,
                    track.motor.name,
                    "enable",
                    (command.time_ns - min(begins)) * 1e-6,
                    float("inf"),
                    "ms",
                    f"{command.kind.value} after a fault that nobody acknowledged",
                )
                break
