"""What decides when a cycle begins: docs/real_time.md."""

from enum import StrEnum

from limber.errors import InputError
from limber.model.scenario import Scenario
from limber.run import buses
from limber.run.options import RunOptions


class Pace(StrEnum):
    """The options of driver, controller and simulator."""

    LOCKSTEP = "lockstep"  # as fast as the processors allow
    PACED = "paced"  # lock step, not faster than the clock
    REALTIME = "realtime"  # each by the clock

    @property
    def option(self) -> str:
        return f"--{self}"


def choose(scenario: Scenario, options: RunOptions) -> Pace:
    """Motors do not wait: what is not simulated by this run is in real time.

    A simulated arm is in lock step: without a clock if the scenario's mode is lockstep, else at
    the clock's pace.
    """
    real = buses.real(buses.addresses(scenario.robot, options.buses))
    simulated = options.with_simulator
    if options.one_process and (real or not simulated or options.lockstep is False):
        raise InputError("--one-process: simulated arms only, in lock step, on virtual buses")
    if options.lockstep and real and not simulated:
        raise InputError(
            f"--lockstep: motors on {' and '.join(real)} wait for nobody; leave it out"
        )
    if options.lockstep is not None:
        return Pace.LOCKSTEP if options.lockstep else Pace.REALTIME
    if real or not simulated:
        return Pace.REALTIME
    return Pace.LOCKSTEP if scenario.lockstep else Pace.PACED
