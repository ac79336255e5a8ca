"""Where the repository, the built programs and the shipped robots are."""

import os
import subprocess
from pathlib import Path
from typing import Any

from limber.errors import InputError, RunError

ROOT = Path(__file__).resolve().parents[2]
RELEASE = ROOT / "build" / "release" / "bin"  # what `limber dev bench` builds
LEFT_BY_RUNS = ("run.lcmlog", "run.lcmlog.zst", "run.can.log", "summary.json")
ASSETS = Path(__file__).resolve().parent / "assets"


def programs_folder() -> Path:
    """Where the C++ programs are: $LIMBER_BIN, or the development build."""
    return Path(os.environ.get("LIMBER_BIN") or ROOT / "build" / "dev" / "bin")


def program(name: str) -> Path:
    """Path of a built C++ program, such as limber-driver."""
    path = programs_folder() / name
    if not os.access(path, os.X_OK):
        raise RunError(
            f"{path} does not exist: run ./limber to build it, or set LIMBER_BIN to its folder"
        )
    return path


def captured(command: list[str], **more: Any) -> subprocess.CompletedProcess[str]:
    """The finished program with what it printed, which is UTF-8 whatever the locale is."""
    return subprocess.run(
        command, capture_output=True, encoding="utf-8", errors="replace", check=False, **more
    )


def robots_root() -> Path:
    return Path(os.environ.get("LIMBER_ROBOTS") or ROOT / "robots")


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
