"""`limber log spy`: LCM's own viewer, lcm-spy, with limber's message types."""

import os
import shutil
import sys
from hashlib import sha256
from pathlib import Path
from typing import NoReturn

from limber import messages
from limber.errors import RunError
from limber.lcm_package import lcm_package
from limber.live.network import require_multicast
from limber.paths import MESSAGE_FILES, REPAIR, cache_folder, captured, command_for

JDK = "sudo apt-get install default-jdk"


def start() -> NoReturn:
    """Becomes lcm-spy, on the address where tools listen to an arm."""
    spy = _beside_python("lcm-spy")
    _require_windows(_program("java"))
    jar = types_jar()
    if not os.environ.get("DISPLAY"):
        raise RunError(
            "lcm-spy needs a display: none is set ($DISPLAY). Over ssh: ssh -X. In a terminal, "
            "`limber watch` shows the arm and `limber log echo` a recorded one"
        )
    require_multicast()
    before = os.environ.get("CLASSPATH")
    os.environ["CLASSPATH"] = f"{jar}:{before}" if before else str(jar)
    os.environ["LCM_DEFAULT_URL"] = messages.user_plane_url()
    print("lcm-spy may list classes of its own that it cannot load: harmless", flush=True)
    os.execv(spy, [spy])


def types_jar() -> Path:
    """The jar of all message types, built unless it is there for these types."""
    sources = sorted(MESSAGE_FILES.glob("*.lcm"))
    version = sha256(b"".join(source.read_bytes() for source in sources)).hexdigest()[:16]
    folder = cache_folder() / "spy"
    jar = folder / f"limber-types-{version}.jar"
    if jar.is_file():
        return jar
    lcm_gen, compiler, archiver = _beside_python("lcm-gen"), _program("javac"), _program("jar")
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "classes").mkdir(parents=True)
    _run([lcm_gen, "--java", "--jpath", str(folder / "java"), *map(str, sources)])
    made = sorted(map(str, (folder / "java").rglob("*.java")))
    _run([compiler, "-nowarn", "-cp", str(lcm_jar()), "-d", str(folder / "classes"), *made])
    part = jar.with_suffix(".part")
    _run([archiver, "cf", str(part), "-C", str(folder / "classes"), "."])
    part.rename(jar)
    return jar


def lcm_jar() -> Path:
    """LCM's classes, which its Python package carries."""
    jar = Path(lcm_package().__file__).parents[1] / "share" / "java" / "lcm.jar"
    if not jar.is_file():
        raise RunError(
            f"{jar} is missing: this LCM was built without Java; the package `lcm` of PyPI has it"
        )
    return jar


def _beside_python(name: str) -> str:
    path = Path(sys.executable).parent / name
    if not path.is_file():
        cure = command_for("lcm") or REPAIR
        raise RunError(f"{path} is missing: it comes with the Python package `lcm`; {cure}")
    return str(path)


def _program(name: str) -> str:
    path = shutil.which(name)
    if path is None:
        raise RunError(f"lcm-spy is a Java program, and `{name}` is not installed: {JDK}")
    return path


def _require_windows(java: str) -> None:
    """A Java without windows starts, and fails with a page of Java's own words."""
    home = Path(java).resolve().parents[1]
    if sys.platform == "linux" and home.name != "usr" and not any(home.rglob("libawt_xawt.so")):
        raise RunError(f"lcm-spy has windows, and the Java in {home} has none: {JDK}")


def _run(command: list[str]) -> None:
    done = captured(command)
    if done.returncode != 0:
        last = (done.stderr or done.stdout).strip().splitlines()[-1:]
        raise RunError(f"{Path(command[0]).name} failed: {''.join(last)}")
