"""Where programs, robots, scenarios and message files are: of a clone, of what pip installed, or of
the Debian package.

A clone has them where they are made; what is installed has `bin`, `lib` and `share/limber` (CMake's
install rules) in the Python package itself, that of Debian in /usr. Nothing is written there.
"""

import os
import subprocess
import sys
import sysconfig
from pathlib import Path
from typing import Any

from limber.errors import InputError, RunError

PACKAGE = Path(__file__).resolve().parent
ROOT = PACKAGE.parents[1]  # of a clone
IN_A_CLONE = (ROOT / "CMakeLists.txt").is_file() and (ROOT / "lcmtypes").is_dir()
DISTRIBUTION = "limber-arm"  # its name for pip
FROM_DEBIAN = not IN_A_CLONE and not (PACKAGE / "share").is_dir()
# /usr/lib/python3/dist-packages/limber is in /usr
PREFIX = ROOT / "build" / "dev" if IN_A_CLONE else PACKAGE.parents[3] if FROM_DEBIAN else PACKAGE
SHARE = ROOT if IN_A_CLONE else PREFIX / "share" / "limber"
SCENARIOS, MESSAGE_FILES = SHARE / "scenarios", SHARE / "lcmtypes"
MULTIARCH = sysconfig.get_config_var("MULTIARCH") if FROM_DEBIAN else ""
CMAKE = PREFIX / "lib" / MULTIARCH / "cmake" / "limber"
REPAIR = (
    "run ./limber to build it"
    if IN_A_CLONE
    else "sudo apt-get install --reinstall limber liblimber0"
    if FROM_DEBIAN
    else f"install {DISTRIBUTION} again"
)
RELEASE = ROOT / "build" / "release" / "bin"  # what `limber dev bench` builds
LEFT_BY_RUNS = ("run.lcmlog", "run.lcmlog.zst", "run.can.log", "summary.json")
ASSETS = PACKAGE / "assets"


def programs_folder() -> Path:
    """Where the C++ programs are: $LIMBER_BIN, the development build, or the package."""
    return Path(os.environ.get("LIMBER_BIN") or PREFIX / "bin")


def private_library(name: str) -> Path:
    """A shared library for Python, beside the programs."""
    found = programs_folder().parent / "lib" / name
    return found if found.exists() else found.parent / "limber" / name  # in /usr


def program(name: str) -> Path:
    """Path of a built C++ program, such as limber-driver."""
    path = programs_folder() / name
    if not os.access(path, os.X_OK):
        raise RunError(f"{path} does not exist: {REPAIR}, or set LIMBER_BIN to its folder")
    return path


def captured(command: list[str], **more: Any) -> subprocess.CompletedProcess[str]:
    """The finished program with what it printed, which is UTF-8 whatever the locale is."""
    return subprocess.run(
        command, capture_output=True, encoding="utf-8", errors="replace", check=False, **more
    )


def completed(command: list[str], **more: Any) -> str:
    """What the program printed. Raises RunError with all of it if the program failed."""
    done = captured(command, **more)
    if done.returncode != 0:
        raise RunError(f"{' '.join(command)} failed:\n{done.stdout}{done.stderr}".rstrip())
    return done.stdout


def robots_root() -> Path:
    return Path(os.environ.get("LIMBER_ROBOTS") or SHARE / "robots")


def robot_names() -> list[str]:
    return sorted(path.parent.name for path in robots_root().glob("*/robot.yaml"))


def robot_folder(name_or_path: str) -> Path:
    """Folder with robot.yaml: a path, or a shipped robot's name."""
    candidates = [Path(name_or_path), robots_root() / name_or_path]
    for folder in candidates:
        if (folder / "robot.yaml").is_file():
            return folder.resolve()
    known = ", ".join(robot_names()) or "none"
    raise InputError(
        f"no robot '{name_or_path}': give a folder with robot.yaml, or one of: {known}"
    )


def scenario_file(name_or_path: Path) -> Path:
    """A file, or a shipped scenario's: `demo`, `demo.yaml` and `scenarios/demo.yaml` name one."""
    shipped = SCENARIOS / name_or_path.with_suffix(".yaml").name
    plain = name_or_path.parent in (Path(), Path("scenarios"))
    if not name_or_path.exists() and plain and shipped.is_file():
        return shipped
    return existing_file(name_or_path, "scenario file (.yaml)")


def cache_folder() -> Path:
    """Where what can be made again is kept: $XDG_CACHE_HOME/limber."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "limber"


# Packages of optional parts, by the module that is imported.
EXTRAS = {"scipy": "identify", "mcap": "mcap", "google": "mcap", "distributed": "sweep"}
EXTRAS |= {"pyarrow": "parquet", "rerun": "rerun", "gymnasium": "gym", "cyclonedds": "ros2"}
EXTRAS |= {"foxglove": "foxglove"}
# For the Debian package: what Debian has, and what it lacks, as in pyproject.toml. The latter goes
# into an environment of the user's that has Debian's packages, too; there `python -m limber`.
DEBIAN = {"scipy": "python3-scipy", "google": "python3-protobuf"}
LACKING = {"lcm": "lcm==1.5.3", "viser": "viser>=1.1,<1.2", "mcap": "mcap>=1.2,<2"}
LACKING |= {"pyarrow": "pyarrow>=18", "rerun": "rerun-sdk>=0.41,<0.42"}
LACKING |= {"distributed": "distributed>=2025.1"}
LACKING |= {"gymnasium": "gymnasium>=1.0,<2", "cyclonedds": "cyclonedds>=11.0.1,<12"}
LACKING |= {"foxglove": "foxglove-sdk>=0.30,<0.31"}


def command_for(module: str) -> str | None:
    """The command that installs what `module` is of; None of what belongs to this installation."""
    if FROM_DEBIAN and module in DEBIAN:
        return f"sudo apt-get install {DEBIAN[module]}"
    if FROM_DEBIAN and module in LACKING and sys.prefix != sys.base_prefix:
        return f"{sys.executable} -m pip install '{LACKING[module]}'"
    if FROM_DEBIAN and module in LACKING:
        return (
            "sudo apt-get install python3-venv && python3 -m venv --system-site-packages "
            "~/limber-python && ~/limber-python/bin/pip "
            f"install '{LACKING[module]}'; then ~/limber-python/bin/python -m limber ..."
        )
    if FROM_DEBIAN or module not in EXTRAS:
        return None
    extra = EXTRAS[module]
    what = f"-e '{ROOT}[{extra}]'" if IN_A_CLONE else f"'{DISTRIBUTION}[{extra}]'"
    return f"{sys.executable} -m pip install {what}"


def existing_file(path: Path, what: str) -> Path:
    if not path.is_file():
        kind = "is a folder" if path.is_dir() else "does not exist"
        raise InputError(f"{path} {kind}; expected a {what}")
    return path


def output_folder(path: Path) -> Path:
    """Makes the folder results go to."""
    try:
        path.mkdir(parents=True, exist_ok=True)
        probe = path / ".writable"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise InputError(
            f"{path} cannot be written ({error.strerror}): give another --out"
        ) from error
    return path


def run_folder(path: Path) -> Path:
    """Makes the folder of a run; one that holds a run already is refused: never overwritten, never
    mixed.
    """
    left = next((name for name in LEFT_BY_RUNS if (path / name).exists()), None)
    if left is not None:
        raise InputError(f"{path} holds a run already ({left}): give another --out, or remove it")
    return output_folder(path)
