"""limber-record in tests."""

import os
import time
from contextlib import contextmanager

from processes import started

from stack import BIN

URL = "udpm://239.255.76.67:7667?ttl=0"


@contextmanager
def recording(path, *options, url=URL):
    """limber-record, once it listens; what it has said is in `path`.txt."""
    said = path.with_suffix(".txt")
    command = [str(BIN / "limber-record"), "--out", str(path), *options]
    surroundings = {**os.environ, "LCM_DEFAULT_URL": url}
    with (
        said.open("w") as log,
        started(command, stdout=log, stderr=log, env=surroundings) as recorder,
    ):
        while "recording" not in said.read_text():
            assert recorder.poll() is None, said.read_text()
            time.sleep(0.02)
        yield recorder
