"""Processes that tests start."""

import subprocess
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def started(command: object, **options) -> Iterator[subprocess.Popen]:
    """subprocess.Popen, as a context that waits for the process's end, unless the test has failed:
    then nobody is left to end it, and it is killed.
    """
    with subprocess.Popen(command, **options) as process:
        try:
            yield process
        except BaseException:
            process.terminate()  # what it started ends, too
            try:
                process.wait(timeout=10)
            except subprocess.TimeoutExpired:
                process.kill()
            raise
