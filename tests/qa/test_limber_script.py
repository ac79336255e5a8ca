"""./limber in a tree of its own, with programs in place of the package manager, CMake and Ninja."""

import hashlib
import os
import re
import shutil
import subprocess
import time
from pathlib import Path

import pytest

from limber.paths import ROOT

NINJA = (
    'echo "$*" >>"$STEPS.built"; echo start >>"$STEPS"; sleep "${NINJA_S:-0}"; echo end >>"$STEPS"'
)
CMAKE = 'echo configure >>"$STEPS"'
LIMBER = 'echo "hand over: $*"; sleep "${LIMBER_S:-0}"'


def executable(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/usr/bin/env bash\n{text}\n", encoding="utf-8")
    path.chmod(0o755)


@pytest.fixture
def tree(tmp_path):
    """Set up and configured: only Ninja is left to run."""
    root = tmp_path / "tree"
    root.mkdir()
    for name in ("limber", "pyproject.toml"):
        shutil.copy(ROOT / name, root)
    for name, text in {"dpkg-query": "echo installed", "ninja": NINJA, "cmake": CMAKE}.items():
        executable(tmp_path / "bin" / name, text)
    executable(root / ".venv" / "bin" / "limber", LIMBER)
    stamp(root)
    cache = root / "build" / "dev" / "CMakeCache.txt"
    cache.parent.mkdir(parents=True)
    cache.write_text(f"CMAKE_HOME_DIRECTORY:INTERNAL={root}\n")
    (root / "build" / "dev" / "build.ninja").touch()
    return root


def stamp(root: Path) -> None:
    """As ./limber does when it has made the Python environment, and what is not the demo's."""
    digest = hashlib.sha256((root / "pyproject.toml").read_bytes()).hexdigest()
    for name in ("environment", "dev"):
        (root / ".venv" / f".limber-{name}").write_text(f"{root} {digest}  -\n")


def start(root: Path, *words: str, **environment: str) -> subprocess.Popen:
    path = f"{root.parent / 'bin'}:{os.environ['PATH']}"
    return subprocess.Popen(
        [root / "limber", *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        stdin=subprocess.DEVNULL,
        text=True,
        env={**os.environ, "PATH": path, "STEPS": str(root.parent / "steps"), **environment},
    )


def steps(root: Path) -> list[str]:
    path = root.parent / "steps"
    return path.read_text().split() if path.exists() else []


def wait_for(condition) -> None:
    deadline = time.monotonic() + 20
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.02)


def test_two_at_once_take_turns(tree):
    first = start(tree, "run", NINJA_S="1")
    wait_for(lambda: steps(tree) == ["start"])
    second = start(tree, "lab")
    out, errors = second.communicate(timeout=20)
    assert out == "hand over: lab\n"
    assert errors == f"limber: waiting for another ./limber, which sets up or builds {tree}\n"
    assert first.communicate(timeout=20) == ("hand over: run\n", "")
    assert steps(tree) == ["start", "end", "start", "end"]


@pytest.mark.parametrize(
    ("words", "built"),
    [
        (("test", "lint"), False),
        (("dev", "test", "lint"), False),
        (("test", "--quick"), False),
        (("test", "eval"), True),
        (("dev", "test", "eval"), True),
    ],
)
def test_a_part_of_the_tests_builds_only_what_it_needs(tree, words, built):
    assert start(tree, *words).communicate(timeout=20) == (f"hand over: {' '.join(words)}\n", "")
    assert steps(tree) == (["start", "end"] if built else [])


def test_the_demo_installs_and_builds_less(tree):
    (tree / ".venv" / ".limber-dev").unlink()
    executable(tree / ".venv" / "bin" / "python", 'echo "$*" >>"$STEPS.installed"')
    built, installed = (tree.parent / f"steps.{name}" for name in ("built", "installed"))
    assert start(tree, "demo").communicate(timeout=20) == ("hand over: demo\n", "")
    assert "limber-sim" in built.read_text() and "limber-send" not in built.read_text()
    assert not installed.exists()
    for told in ("limber: installing the packages of limber-arm[dev]: 0.6 GB\n", ""):
        assert start(tree, "lab").communicate(timeout=20) == ("hand over: lab\n", told)
    assert "limber-send" in built.read_text()
    assert installed.read_text().splitlines()[0].endswith(f"--editable {tree}[dev]")
    assert len(installed.read_text().splitlines()) == 1


def test_nobody_waits_for_the_program(tree):
    """The turn is over when ./limber hands over; children of the program do not keep it either."""
    long = start(tree, "run", LIMBER_S="20")
    wait_for(lambda: steps(tree) == ["start", "end"])
    assert long.stdout.readline() == "hand over: run\n"
    assert start(tree, "watch").communicate(timeout=10) == ("hand over: watch\n", "")
    assert long.poll() is None
    open_files = [os.readlink(f) for f in Path(f"/proc/{long.pid}/fd").iterdir()]
    assert not [name for name in open_files if re.search("tree/limber$", name)]
    long.kill()
    long.communicate()


def test_a_copied_tree_is_configured_for_its_new_place(tree):
    copy = tree.parent / "copy"
    shutil.copytree(tree, copy)
    stamp(copy)
    out, errors = start(copy, "lab").communicate(timeout=20)
    assert (out, errors) == ("hand over: lab\n", "limber: configuring the build\n")
    assert steps(copy) == ["configure", "start", "end"]


def test_a_build_without_limbers_environment_is_configured_for_it(tree):
    """`cmake --preset dev` alone makes an environment with what the build needs, and no more."""
    cache = tree / "build" / "dev" / "CMakeCache.txt"
    with open(cache, "a", encoding="utf-8") as file:
        file.write(f"LIMBER_VENV:PATH={tree}/build/dev/python\n")
    assert start(tree, "lab").communicate(timeout=20)[1] == "limber: configuring the build\n"


def test_through_a_link_and_from_elsewhere(tree, tmp_path, monkeypatch):
    (tmp_path / "link").symlink_to(tree)
    monkeypatch.chdir("/")
    assert start(tmp_path / "link", "lab").communicate(timeout=20) == ("hand over: lab\n", "")
