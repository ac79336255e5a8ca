"""`limber bench`: builds the release preset and runs its benchmarks."""

import subprocess
import sys

from rich.console import Console

from limber.errors import OK, RunError
from limber.live import network
from limber.paths import RELEASE, ROOT

PROGRAMS = {
    "limber-bench": [],
    "limber-bench-loop": ["--controller", str(RELEASE / "limber-controller")],
}
MODULES = ("limber.dev.bench_receiver", "limber.dev.bench_page", "limber.dev.bench_viewer")


def bench(console: Console) -> int:
    """Runs in a private network where that is permitted, away from other messages."""
    for command in (["cmake", "--preset", "release"], ["cmake", "--build", "--preset", "release"]):
        _run(command, console)
    prefix = network.private_command() or []
    for name, arguments in PROGRAMS.items():
        _run([*prefix, str(RELEASE / name), *arguments], console, name)
    for module in MODULES:
        _run([*prefix, sys.executable, "-m", module], console, module)
    return OK


def _run(command: list[str], console: Console, title: str | None = None) -> None:
    title = title or " ".join(command)
    console.rule(title)
    try:
        code = subprocess.run(command, cwd=ROOT, check=False).returncode
    except FileNotFoundError as error:
        raise RunError(f"{command[0]} is missing") from error
    if code != 0:
        raise RunError(f"{title} failed (exit code {code}): see above")
