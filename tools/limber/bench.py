"""`limber bench`: builds the release preset and runs every benchmark in it."""

import subprocess

from rich.console import Console

from limber.errors import OK, RunError
from limber.paths import ROOT


def bench(arguments: list[str], console: Console) -> int:
    for command in (["cmake", "--preset", "release"], ["cmake", "--build", "--preset", "release"]):
        console.print("[dim]" + " ".join(command) + "[/]", highlight=False)
        if subprocess.run(command, cwd=ROOT, check=False).returncode != 0:
            raise RunError(f"'{' '.join(command)}' failed: see above")
    programs = sorted((ROOT / "build" / "release" / "bench").glob("bench_*"))
    programs = [path for path in programs if path.is_file()]
    if not programs:
        raise RunError("build/release/bench holds no benchmark")
    for path in programs:
        console.rule(path.name)
        if subprocess.run([str(path), *arguments], cwd=ROOT, check=False).returncode != 0:
            raise RunError(f"{path.name} failed: see above")
    return OK
