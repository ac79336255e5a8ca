"""Runs the programs of `limber dev bench`."""

import json
import subprocess
import sys
from typing import Any

from rich.console import Console

from limber.errors import RunError
from limber.paths import RELEASE, ROOT


def run(
    command: list[str],
    console: Console | None,
    title: str | None = None,
    env: dict[str, str] | None = None,
) -> str:
    """What the program prints; without a console it is only returned."""
    title = title or command[0]
    if console is not None:
        console.rule(title)
    to = subprocess.PIPE if console is None else (sys.stderr if console.stderr else None)
    try:
        done = subprocess.run(command, cwd=ROOT, check=False, stdout=to, text=True, env=env)
    except FileNotFoundError as error:
        raise RunError(f"{command[0]} is missing") from error
    if done.returncode != 0:
        raise RunError(f"{title} failed (exit code {done.returncode}): see above")
    return done.stdout or ""


def released(name: str) -> str:
    """A program of the release build."""
    return str(RELEASE / name)


def report(prefix: list[str], name: str, *options: str) -> dict[str, Any]:
    """The JSON that a program of the release build prints."""
    found: dict[str, Any] = json.loads(run([*prefix, released(name), *options], None))
    return found
