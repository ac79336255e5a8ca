"""Which motor turns which joint, as far as buses tell: found on them, else guessed."""

import subprocess
from dataclasses import dataclass, field

import yaml

from limber.errors import InputError, RunError
from limber.model.can_address import full_address
from limber.model.protocols import Protocol, protocol, protocols
from limber.paths import program

BUSES_MOST = 4
SCAN_S = 120.0


@dataclass(frozen=True)
class Motor:
    """`keys`: of robot.yaml, by section, as the motor has them stored; `most.NAME` bounds a value
    that robot.yaml has under another name. `found_on`: the bus; empty if all of this is a guess.
    """

    drives: Protocol
    bus: str
    number: int
    fd: bool
    found_on: str = ""
    keys: dict[str, float | str] = field(default_factory=dict)

    def key(self, section: str, *names: str) -> tuple[str, float | str] | None:
        """The first of these that is known, with its name."""
        values = ((name, self.keys.get(f"{section}.{name}")) for name in names)
        return next(((name, value) for name, value in values if value is not None), None)

    def most(self, name: str) -> float:
        """The largest value of position_rad, torque_Nm, ... that it takes; inf: none is known."""
        known = [value for key, value in self.keys.items() if key.split(".")[-1] == name]
        return min([self.drives.most(name), *(float(value) for value in known)])

    @property
    def word(self) -> str:
        return f"{self.drives.word}:{self.number}"


def guessed(drives: Protocol, joints: int) -> list[Motor]:
    """Numbers from 1 on each bus, in the order of the joints."""
    count = min(BUSES_MOST, -(-joints // drives.joints_a_bus))
    share = -(-joints // count)
    return [
        Motor(drives, f"can{i // share}", i % share + 1, drives.usually_fd) for i in range(joints)
    ]


def found(addresses: list[str], fd: bool, only: str | None) -> list[Motor]:
    """All that answer, bus by bus, by number; `only`: of this family. Raises InputError if there is
    none, or two have one number.
    """
    family = protocol(only) if only else None
    motors: list[Motor] = []
    for index, address in enumerate(dict.fromkeys(addresses)):
        for entry in sorted(_scan(address, fd), key=lambda entry: int(entry["number"])):
            drives = protocol(entry["family"])
            motor = Motor(drives, f"can{index}", entry["number"], fd, address, entry["keys"])
            if any((one.bus, one.word) == (motor.bus, motor.word) for one in motors):
                raise InputError(f"{address}: two motors answer to {motor.word}")
            if family in (None, drives):
                motors.append(motor)
    if not motors:
        what = f"{family.title} motor" if family else "motor"
        raise InputError(f"no {what} answers on {', '.join(addresses)}")
    return motors


def _scan(address: str, fd: bool) -> list[dict]:
    words = ["scan", full_address(address), "--yaml", *["--fd"] * fd]
    command = [str(program("limber-motors")), *words]
    done = subprocess.run(command, capture_output=True, text=True, timeout=SCAN_S, check=False)
    if done.returncode != 0 and "no motor answers" not in done.stderr:
        raise RunError(f"{address}: {done.stderr.strip().splitlines()[-1]}")
    return yaml.safe_load(done.stdout) or []


def family_of(motors: list[Motor]) -> Protocol:
    """The only one among them. Raises InputError."""
    words = sorted({motor.drives.word for motor in motors})
    if len(words) > 1:
        raise InputError(f"motors of {' and '.join(words)} answer, but not one a joint: --drives")
    return next(entry for entry in protocols() if entry.word == words[0])
