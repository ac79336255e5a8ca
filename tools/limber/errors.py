"""The failures a user can cause or meet, each with its exit code."""

OK = 0
OUT_OF_TOLERANCE = 1
WRONG_INPUT = 2
RUN_FAILED = 3


class LimberError(Exception):
    """An error for the user: shown as one line, never as a traceback."""

    exit_code = RUN_FAILED


class InputError(LimberError):
    """An argument or a file is wrong; the message includes what is expected."""

    exit_code = WRONG_INPUT


class RunError(LimberError):
    """The arguments were right, but a process died, a tool is missing, a disk is full."""

    exit_code = RUN_FAILED
