"""One verdict on one trace."""

from dataclasses import dataclass
from pathlib import Path

from limber.errors import InputError, RunError
from limber_qa.check_trace import stops
from limber_qa.check_trace.arm import Arm, read_arm
from limber_qa.check_trace.candump import Trace, read_trace
from limber_qa.check_trace.drives import decoder
from limber_qa.check_trace.rules import LIMITS, Breach, Track
from limber_qa.check_trace.stops import Expectation


@dataclass(frozen=True)
class Verdict:
    """`stop_ms`: from the fault told to the first safe frame of the slowest drive."""

    breaches: list[Breach]
    commands: int
    states: int
    stop_ms: float | None
    start_ns: int

    @property
    def passed(self) -> bool:
        return not self.breaches


def tracks_of(trace: Trace, arm: Arm) -> list[Track]:
    """Raises InputError for a protocol that the trace checker cannot read."""
    tracks = []
    for motor in arm.motors:
        drive = decoder(motor.protocol)
        tracks.append(
            Track(
                motor,
                arm.period_ns,
                drive.resolution_Nm(motor),
                drive.TELLS_HOLD,
                drive.commands(motor, trace),
                drive.states(motor, trace),
            )
        )
    return tracks


def judge(trace: Trace, arm: Arm, expected: Expectation | None = None) -> Verdict:
    """Raises InputError if the trace has not one frame to or from a motor of the arm."""
    expected = expected or Expectation()
    tracks = tracks_of(trace, arm)
    commands = sum(len(track.commands) for track in tracks)
    states = sum(len(track.states) for track in tracks)
    if commands + states == 0:
        raise InputError(
            f"the trace has no frame of a motor of {arm.name}; its interfaces are "
            f"{', '.join(sorted({name for name, _ in trace.frames})) or 'none'}"
        )
    breaches = [breach for track in tracks for rule in LIMITS for breach in rule(track)]
    for rule in (stops.told_stops, stops.seen_stops, stops.stays_stopped):
        breaches += rule(tracks, expected)
    return Verdict(
        sorted(breaches, key=lambda breach: breach.time_ns),
        commands,
        states,
        _slowest_ms(tracks, expected),
        trace.span_ns[0],
    )


def _slowest_ms(tracks: list[Track], expected: Expectation) -> float | None:
    if expected.fault_ns is None:
        return None
    times = [stops.stop_time_ns(track, expected.fault_ns) for track in tracks if track.tells_hold]
    told = [time for time in times if time is not None]
    return max(told) * 1e-6 if told and len(told) == len(times) else None


def judge_file(
    path: Path,
    robot: str,
    expected: Expectation | None = None,
    addresses: dict[str, str] | None = None,
) -> Verdict:
    """`addresses` as of read_arm. Raises InputError for what cannot be read."""
    return judge(read_trace(path), read_arm(robot, addresses), expected)


def require_no_breach(path: Path, robot: str) -> None:
    """Raises RunError with the first breach, for runs that have none to make."""
    breaches = judge_file(path, robot).breaches
    if breaches:
        first = breaches[0]
        raise RunError(
            f"{path}: {len(breaches)} breaches; at {first.time_ns * 1e-9:.4f} s "
            f"{first.joint}: {first.rule} {first.number:.4g} {first.unit} "
            f"(limit {first.limit:.4g}): {first.text}"
        )
