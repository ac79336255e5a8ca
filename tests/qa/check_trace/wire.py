"""Frames made by hand for a small arm: two Damiao drives as desktop2r has them, and their limits.

Bytes are computed here once more, so that a slip in the trace checker's decoders shows.
"""

from pathlib import Path

from limber_qa.check_trace.arm import Arm, read_arm
from limber_qa.check_trace.candump import read_trace
from limber_qa.check_trace.judge import Verdict, judge
from limber_qa.check_trace.stops import Expectation

ARM: Arm = read_arm("desktop2r")
PERIOD_us = 1000
TORQUE_LIMIT_Nm = 7.0  # peak of the motors; the fields go to 10
STEP_Nm = 0.35  # the limit in 20 ms
COUNT_Nm = 20.0 / 4095
ENABLE, DISABLE = "FFFFFFFFFFFFFFFC", "FFFFFFFFFFFFFFFD"


def counts(value: float, bits: int, end: float) -> int:
    """The nearest count of a field from -end to end."""
    return round((value + end) / (2 * end) * (2**bits - 1))


def command(torque: float = 0.0, kp: float = 0.0, kd: float = 0.0, angle: float = 0.0) -> str:
    """Eight bytes: p 16, v 12, kp 12, kd 12, t 12 bits."""
    fields = (
        (counts(angle, 16, 12.5), 16),
        (counts(0.0, 12, 30.0), 12),
        (round(kp / 500 * 4095), 12),
        (round(kd / 5 * 4095), 12),
        (counts(torque, 12, 10.0), 12),
    )
    value = 0
    for count, bits in fields:
        value = value << bits | count
    return f"{value:016X}"


def reply(number: int, angle: float = 0.0, speed: float = 0.0, status: int = 1) -> str:
    value = status << 4 | number
    for count, bits in (
        (counts(angle, 16, 12.5), 16),
        (counts(speed, 12, 30.0), 12),
        (counts(0.0, 12, 10.0), 12),
    ):
        value = value << bits | count
    return f"{value:012X}2828"


class Wire:
    """A trace that grows cycle by cycle. What is not given is a quiet motor that follows."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.cycle = 0

    def frame(self, number: str, data: str, offset_us: int = 0) -> None:
        time_us = self.cycle * PERIOD_us + offset_us
        stamp = f"({time_us // 10**6}.{time_us % 10**6:06d})"
        self.lines.append(f"{stamp} desktop2r {number}#{data}")

    def step(
        self,
        shoulder: str | None = None,
        shoulder_reply: str | None = None,
        elbow: str | None = None,
        elbow_reply: str | None = None,
        times: int = 1,
    ) -> None:
        """So many cycles; "" leaves a frame out."""
        for _ in range(times):
            frames = (
                ("001", shoulder, command(), 0),
                ("002", elbow, command(), 1),
                ("011", shoulder_reply, reply(1), 300),
                ("012", elbow_reply, reply(2), 400),
            )
            for number, given, usual, offset_us in frames:
                data = usual if given is None else given
                if data:
                    self.frame(number, data, offset_us)
            self.cycle += 1

    def judged(self, folder: Path, expected: Expectation | None = None) -> Verdict:
        path = folder / "trace.log"
        path.write_text("\n".join(self.lines) + "\n", encoding="ascii")
        return judge(read_trace(path), ARM, expected)
