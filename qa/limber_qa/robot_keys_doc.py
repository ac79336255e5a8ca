"""The table of required keys in robots/README.md, written from the loader's."""

import subprocess

from limber.paths import ROOT, program
from limber_qa.written_table import WrittenTable


def _lines() -> list[str]:
    command = [str(program("limber-check")), "keys"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return done.stdout.splitlines()


TABLE = WrittenTable(ROOT / "robots" / "README.md", "required keys", _lines)
