"""The rules, each over the commands to one motor and the states it reports."""

import math
from bisect import bisect_left
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

from limber_qa.check_trace.arm import Motor
from limber_qa.check_trace.events import Command, Kind, State

SPEED_MARGIN = 1.1  # of the limit, for so many replies in a row:
FAST_REPLIES = 3
COMES_AT = 0.9  # of the torque rate, towards braking
POSITION_MARGIN = 0.02  # rad or m, beyond the limit
GRACE_REPLIES = 1  # the command on its way when the reply arrives
FAR_OUTSIDE = 0.15  # rad or m: where a hold cannot be told from a command
EXPLAINED = 1.25  # of what the hold gains make at the reported speed


@dataclass(frozen=True)
class Breach:
    """A rule that a motor's frame breaks: `number` is beyond `limit`, both in `unit`."""

    time_ns: int
    joint: str
    rule: str
    number: float
    limit: float
    unit: str
    text: str


@dataclass(frozen=True)
class Track:
    """A motor's traffic. `tells_hold`: its protocol has the drive's stiffness and damping."""

    motor: Motor
    period_ns: int
    resolution_Nm: float
    tells_hold: bool
    commands: list[Command]
    states: list[State]

    @cached_property
    def seen(self) -> list[int]:
        """For each command, how many states were reported before it."""
        times = [state.time_ns for state in self.states]
        return [bisect_left(times, command.time_ns) for command in self.commands]

    def last(self, command: int, count: int) -> list[State]:
        """The `count` states before a command; fewer if there are not so many."""
        end = self.seen[command]
        return self.states[max(end - count, 0) : end]

    def breach(
        self, command: Command, rule: str, number: float, limit: float, unit: str, text: str
    ) -> Breach:
        return Breach(command.time_ns, self.motor.name, rule, number, limit, unit, text)


def frames(track: Track) -> Iterator[Breach]:
    """Every frame to the drive is a command of its protocol."""
    for command in track.commands:
        if command.kind is Kind.INVALID:
            yield track.breach(command, "frame", math.nan, math.nan, "", command.text)


def finite(track: Track) -> Iterator[Breach]:
    """No number in a command is NaN or infinite."""
    for command in track.commands:
        numbers = (command.torque, command.position, command.velocity, command.kp, command.kd)
        if command.kind.commands and not all(map(math.isfinite, numbers)):
            wrong = next(number for number in numbers if not math.isfinite(number))
            yield track.breach(command, "finite", wrong, math.nan, "", "no finite number")


def torque(track: Track) -> Iterator[Breach]:
    """The torque is within the limit, with what the drive's stiffness adds; damping only brakes."""
    limit = track.motor.torque_Nm
    for number, command in enumerate(track.commands):
        if not command.kind.commands:
            continue
        margin = 0.5 * track.resolution_Nm
        total = command.torque
        for state in track.last(number, 1):
            spring = command.kp * (command.position - state.position)
            total += spring
            margin += 2.0 * command.kp * abs(state.velocity) * track.period_ns * 1e-9
            margin += abs(spring) * 0.01
        if abs(total) > limit + margin or abs(command.torque) > limit + track.resolution_Nm:
            yield track.breach(command, "torque", total, limit, "N m", "commanded torque")


def rate(track: Track) -> Iterator[Breach]:
    """From frame to frame the torque steps by no more than the limit, unless the drive is stopped.

    A drive without stiffness and damping of its own gets what the driver's hold makes at the speed
    reported, too; that much is not told from a step of the controller's.
    """
    before: Command | None = None
    for number, command in enumerate(track.commands):
        if command.kind in (Kind.ENABLE, Kind.DISABLE):
            before = command
            continue
        if not command.kind.commands or not math.isfinite(command.torque):
            continue
        state = next(iter(track.last(number, 1)), None)
        if before is not None and not _is_braking(track, command, state):
            step = command.torque - _torque_of(before, command, state)
            limit = _step_limit(track, before, command, state)
            if abs(step) > limit + 2.0 * track.resolution_Nm:
                yield track.breach(command, "rate", step, limit, "N m", "torque step")
        before = command


def _torque_of(before: Command, now: Command, state: State | None) -> float:
    """What a command after a hold is compared with: all that the drive makes."""
    if before.kind is not Kind.HOLD or now.kind is not Kind.FOLLOW or state is None:
        return before.torque
    return (
        before.torque
        + before.kp * (before.position - state.position)
        + before.kd * (before.velocity - state.velocity)
    )


def _step_limit(track: Track, before: Command, now: Command, state: State | None) -> float:
    motor = track.motor
    periods = max(1, round((now.time_ns - before.time_ns) / track.period_ns))
    limit = motor.torque_step_Nm * periods
    if not track.tells_hold and state is not None:
        speed = abs(state.motor_velocity)
        limit += EXPLAINED * (motor.kd * speed + motor.kp * speed * track.period_ns * 1e-9)
    return limit


def _is_braking(track: Track, command: Command, state: State | None) -> bool:
    """Damping alone; where that is not told, a torque that the hold's damping explains."""
    if command.kind is Kind.DAMP or track.tells_hold:
        return command.kind is Kind.DAMP
    most = 0.0 if state is None else EXPLAINED * track.motor.kd * abs(state.motor_velocity)
    return abs(command.torque) <= most + 2.0 * track.resolution_Nm


def speed(track: Track) -> Iterator[Breach]:
    """A joint above 110 % of its speed limit for three replies is commanded to brake."""
    if track.motor.velocity is None:
        return
    limit = SPEED_MARGIN * track.motor.velocity
    count = FAST_REPLIES + GRACE_REPLIES

    def fast(state: State) -> bool:
        return state.enabled and abs(state.velocity) > limit

    for number, command in enumerate(track.commands):
        if command.kind not in (Kind.FOLLOW, Kind.HOLD):
            continue
        last = track.last(number, count)
        if len(last) < count or not all(map(fast, last)):
            continue
        if command.kind is Kind.FOLLOW and command.torque * last[-1].velocity <= 0.0:
            continue  # against the motion
        if command.kind is Kind.HOLD and _comes_to_brake(track, number, last[-1]):
            continue
        text = "joint speed, and no command to brake"
        yield track.breach(command, "speed", last[-1].velocity, limit, "rad/s", text)


def _comes_to_brake(track: Track, number: int, state: State) -> bool:
    """Feed-forward and damping together brake, or go there at the torque's rate."""
    command, before = track.commands[number], track.commands[number - 1]
    if command.kp != 0.0:
        return False
    way = math.copysign(1.0, state.velocity)
    now = way * (command.torque - command.kd * state.velocity)
    step = way * (before.torque - before.kd * state.velocity) - now
    return now <= 0.0 or step >= COMES_AT * track.motor.torque_step_Nm - track.resolution_Nm


def position(track: Track) -> Iterator[Breach]:
    """A joint beyond its limit by more than the margin does not follow a controller."""
    if track.motor.position is None:
        return
    margin = POSITION_MARGIN if track.tells_hold else FAR_OUTSIDE
    low, high = track.motor.position[0] - margin, track.motor.position[1] + margin
    count = 1 + GRACE_REPLIES
    for number, command in enumerate(track.commands):
        if command.kind is not Kind.FOLLOW:
            continue
        last = track.last(number, count)
        if len(last) == count and all(
            state.enabled and not low <= state.position <= high for state in last
        ):
            angle = last[-1].position
            limit = low if angle < low else high
            text = "joint angle, and follows on"
            yield track.breach(command, "position", angle, limit, "rad", text)


LIMITS: tuple[Callable[[Track], Iterator[Breach]], ...] = (
    frames,
    finite,
    torque,
    rate,
    speed,
    position,
)
