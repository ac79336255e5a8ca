"""What the programs' logs know of a fault beyond its number, which is all that messages hold."""

import re
from dataclasses import replace
from pathlib import Path

from limber.measure.faults import Fault

TELLERS = ("limber-driver.log", "limber-lab.log")
PROCESSES = (*TELLERS, "limber-sim.log", "limber-controller.log")
STALL = re.compile(r"(limber-\w+) stood still for (\d+) ms")
# What a process that stood still looks like to the others, before any cable.
BY_A_STALL = {
    "driver.REPLY_LOST",
    "driver.CONFIGURATION",
    "driver.CONTROLLER_LOST",
    "driver.OVERRUN",
    "controller.STATE_LOST",
}


def with_words(faults: list[Fault], folder: Path) -> list[Fault]:
    """The faults with what the driver logged of them, and which process stood still, as `measured`.

    Left as they are where the log of the run tells of more or fewer faults of that kind and joint.
    """
    log = "\n".join(_text(folder / name) for name in TELLERS)
    stalls = _stalls(folder)
    kinds = dict.fromkeys((fault.problem.code, fault.joint) for fault in faults)
    for code, joint in kinds:
        places = [k for k, f in enumerate(faults) if (f.problem.code, f.joint) == (code, joint)]
        words = _words(faults[places[0]], log)
        if len(places) == len(words):
            for k, text in zip(places, words, strict=True):
                if text:
                    faults[k] = replace(faults[k], measured=text)
        if stalls and code in BY_A_STALL:
            for k in places:
                parts = (stalls, faults[k].measured)
                faults[k] = replace(faults[k], measured="; ".join(part for part in parts if part))
    return faults


def _text(path: Path) -> str:
    return path.read_text(encoding="utf-8", errors="replace") if path.exists() else ""


def _stalls(folder: Path) -> str:
    """ "limber-sim stood still for 480 ms" of the longest of each process; "" if none did."""
    longest: dict[str, int] = {}
    for name in PROCESSES:
        for program, milliseconds in STALL.findall(_text(folder / name)):
            longest[program] = max(longest.get(program, 0), int(milliseconds))
    return ", ".join(f"{program} stood still for {ms} ms" for program, ms in longest.items())


def _words(fault: Fault, log: str) -> list[str]:
    where = f" ({fault.joint})" if fault.joint else ""
    begin = re.escape(f"{fault.problem.code}: {fault.problem.what}{where}")
    end = re.escape(f"; {fault.problem.remedy}")
    return [text.removeprefix(": ") for text in re.findall(f"{begin}(.*?){end}", log)]
