"""The first minute of a newcomer, in a terminal of 80 by 24."""

import fcntl
import os
import pty
import re
import struct
import subprocess
import sys
import termios

from stack import ROOT

COLUMNS, ROWS = 80, 24
ANSI = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]|\x1b[()][A-Z0-9]")


def in_terminal(
    *arguments: str, timeout_s: float = 120, answers: dict[str, str] | None = None
) -> tuple[int, str]:
    """Exit code and all that was written to the terminal. `answers`: what is typed once a text has
    been written, each once.
    """
    waiting = dict(answers or {})
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", ROWS, COLUMNS, 0, 0))
    environment = {**os.environ, "TERM": "xterm-256color"}
    environment.pop("COLUMNS", None)
    process = subprocess.Popen(
        [sys.executable, "-m", "limber", *arguments],
        stdin=theirs,
        stdout=theirs,
        stderr=theirs,
        cwd=ROOT,
        env=environment,
        close_fds=True,
    )
    os.close(theirs)
    written = b""
    while True:
        try:
            piece = os.read(ours, 65536)
        except OSError:  # the other end is closed
            break
        if not piece:
            break
        written += piece
        for text in [text for text in waiting if text.encode() in written]:
            os.write(ours, waiting.pop(text).encode())
    os.close(ours)
    return process.wait(timeout_s), written.decode(errors="replace")


def test_the_demo_tells_its_message(tmp_path):
    code, written = in_terminal("demo", "--seconds", "8", "--out", str(tmp_path))
    text = ANSI.sub("", written)
    assert code == 0, text[-3000:]
    for sentence in (
        "A simulated openarm on a CAN bus",
        "the arm, from the side",
        "A hand pushes with 9 N along +x.",
        "lets go",
        "How soft is the tip?",
        "what a hand on the arm feels",
        "the demo in one picture",
    ):
        assert sentence in re.sub(r"\s+", " ", text), sentence
    assert "Traceback" not in text and "out of tolerance" not in text
    lines = [line for line in re.split("[\r\n]", text) if str(tmp_path) not in line]
    assert max(len(line) for line in lines) <= COLUMNS
    table = next(line for line in lines if "spring alone" in line)
    assert re.search(r"along\s+pushed\s+moved\s+felt\s+friction\s+spring alone\s+asked", table)
