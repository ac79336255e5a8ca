"""limber for aarch64 from another machine: Debian's cross compiler, and a folder with Debian's
packages for arm64, whose maintainer scripts need not run.
"""

import os
import re
import shutil
from pathlib import Path

from limber.errors import RunError
from limber.paths import ROOT, completed

MACHINE = "aarch64"
COMPILER = "aarch64-linux-gnu-g++"
TOOLCHAIN = ROOT / "packaging" / "aarch64.cmake"
SUITE = "bookworm"  # as the wheel's policy, release.POLICY
LIBRARIES = "usr/lib/aarch64-linux-gnu"
MORE = ("libstdc++-12-dev", "libgtest-dev")  # the compiler's own, and the unit tests'


def check_tools() -> None:
    """RunError with what is to be installed."""
    needed = {"mmdebstrap": "mmdebstrap", COMPILER: "g++-aarch64-linux-gnu"}
    missing = [package for program, package in needed.items() if shutil.which(program) is None]
    if missing:
        raise RunError(
            f"{' and '.join(missing)} missing, by which limber is built for {MACHINE}: "
            f"sudo apt-get install {' '.join(missing)}"
        )


def packages() -> list[str]:
    """The libraries of packaging/debian/control."""
    control = (ROOT / "packaging" / "debian" / "control").read_text(encoding="utf-8")
    needed = control.split("Build-Depends:")[1].split("Standards-Version:")[0]
    return [*re.findall(r"\S+-dev\b", needed), *MORE]


def make_sysroot(folder: Path) -> None:
    """Into a folder that does not exist. Absolute links become relative: else the linker passes
    over libm.so and takes libm.a, in silence.
    """
    mirror = filter(None, [os.environ.get("LIMBER_DEBIAN_MIRROR")])
    extract = ["mmdebstrap", "--variant=extract", "--architectures=arm64"]
    completed([*extract, f"--include={','.join(packages())}", SUITE, str(folder), *mirror])
    for link in (folder / LIBRARIES).iterdir():
        if link.is_symlink() and os.path.isabs(target := os.readlink(link)):
            link.unlink()
            link.symlink_to(os.path.relpath(f"{folder}{target}", link.parent))


def emulator(sysroot: Path) -> list[str]:
    """Runs a program for aarch64, by Debian's qemu-user-static."""
    return ["qemu-aarch64-static", "-L", str(sysroot)]


def environment(sysroot: Path) -> dict[str, str]:
    """Beside the usual: for CMake, and for auditwheel, which grafts the libraries."""
    return {
        "CMAKE_TOOLCHAIN_FILE": str(TOOLCHAIN),
        "LIMBER_SYSROOT": str(sysroot),
        "AUDITWHEEL_LD_LIBRARY_PATH": str(sysroot / LIBRARIES),
    }
