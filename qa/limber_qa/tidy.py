"""`limber dev tidy`: clang-tidy over C++ sources, by the rules of .clang-tidy."""

import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor

from rich.console import Console

from limber.errors import RunError
from limber.paths import ROOT, completed
from limber_qa.quick import changed
from limber_qa.selftest import JOBS, cxx_files

BUILD = ROOT / "build" / "tidy"  # each file's command; nothing but the messages is compiled
CONFIGURE = [
    *("cmake", "-S", str(ROOT), "-B", str(BUILD), "-G", "Ninja", "-DCMAKE_CXX_COMPILER=clang++"),
    *("-DLIMBER_UNITY=0", "-DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON"),
    *("-DCMAKE_EXPORT_COMPILE_COMMANDS=ON", "-DLIMBER_BUILD_BENCH=ON"),
]


def sources(names: list[str], everything: bool) -> list[str]:
    """Of these, of all, or of what changed since the last commit; a header is read by its users."""
    known = {str(path) for path in cxx_files() if path.suffix == ".cc"}
    if everything:
        return sorted(known)
    if strangers := sorted(set(names) - known):
        raise RunError(f"{strangers[0]}: no C++ source of this clone, such as sim/joints/spring.cc")
    return names or [name for name in changed() if name in known]


def run(names: list[str], everything: bool, console: Console) -> bool:
    for program, package in {"clang-tidy": "clang-tidy", "clang++": "clang"}.items():
        if shutil.which(program) is None:
            raise RunError(f"needs {program}: sudo apt-get install {package}")
    files = sources(names, everything)
    completed(CONFIGURE, cwd=ROOT)
    completed(["ninja", "-C", str(BUILD), "limber_messages"], cwd=ROOT)

    def read(file: str) -> tuple[str, subprocess.CompletedProcess[str]]:
        command = ["clang-tidy", "--quiet", "-p", str(BUILD), str(ROOT / file)]
        return file, subprocess.run(command, capture_output=True, text=True, check=False)

    good = True
    with ThreadPoolExecutor(JOBS) as pool:
        for number, (file, done) in enumerate(pool.map(read, files), 1):
            good &= done.returncode == 0
            console.print(f"{number} of {len(files)}: {file}", highlight=False)
            if done.returncode:
                console.print(done.stdout, markup=False, highlight=False, soft_wrap=True)
    return good
