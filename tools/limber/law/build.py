"""Compiles the folder of a law, with CMake and the compiler of this machine."""

import shutil
from pathlib import Path

from limber.errors import InputError, RunError
from limber.paths import CMAKE, completed

PACKAGES = "cmake g++ libeigen3-dev"


def law_file(path: Path) -> Path:
    """The shared library: `path` itself, or what its folder is compiled to. Raises InputError, or
    RunError with what the compiler printed.
    """
    if not path.is_dir():
        return path
    if not (path / "CMakeLists.txt").is_file():
        raise InputError(f"{path} holds no CMakeLists.txt: limber law new writes one")
    if shutil.which("cmake") is None:
        raise RunError(f"a law is compiled with CMake: sudo apt-get install {PACKAGES}")
    build = path / "build"
    completed(["cmake", "-S", str(path), "-B", str(build), f"-Dlimber_DIR={CMAKE}"])
    completed(["cmake", "--build", str(build)])
    made = sorted(build.glob("*.so"))
    if len(made) != 1:
        found = ", ".join(file.name for file in made) or "none"
        raise InputError(f"{build}: expected one shared library, found {found}")
    return made[0]
