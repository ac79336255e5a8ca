"""What a drive's error is, in the words of the driver's log: messages hold its number only."""

import re
from dataclasses import replace
from pathlib import Path

from limber.measure.faults import Fault

TELLERS = ("limber-driver.log", "limber-lab.log")
CODE = "driver.DRIVE_ERROR"


def with_words(faults: list[Fault], folder: Path) -> list[Fault]:
    """The faults with what a drive reports, or which setting was changed, as `measured`.

    Left as they are where the log of the run tells of more or fewer errors of that joint.
    """
    log = "\n".join(
        (folder / name).read_text(encoding="utf-8", errors="replace")
        for name in TELLERS
        if (folder / name).exists()
    )
    said = {fault.joint: _words(fault, log) for fault in faults if fault.problem.code == CODE}
    for joint, words in said.items():
        places = [
            k
            for k, fault in enumerate(faults)
            if (fault.problem.code, fault.joint) == (CODE, joint)
        ]
        if len(places) == len(words):
            for k, text in zip(places, words, strict=True):
                faults[k] = replace(faults[k], measured=text)
    return faults


def _words(fault: Fault, log: str) -> list[str]:
    begin = re.escape(f"{CODE}: {fault.problem.what} ({fault.joint}): ")
    end = re.escape(f"; {fault.problem.remedy}")
    return re.findall(f"{begin}(.*?){end}", log)
