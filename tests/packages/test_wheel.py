"""What pip installs is what the tree runs: the same programs, without the tree."""

import filecmp
import re
import subprocess
import zipfile

import pytest

from limber import __version__
from limber.paths import ROOT
from limber_qa import release

NAMES = ("driver", "controller", "sim", "lab", "check", "record", "send", "can")
PROGRAMS = {f"limber-{name}" for name in NAMES}
LARGEST_WHEEL = 6_000_000  # bytes
LARGEST_INSTALLATION = 220_000_000  # bytes, with all that it needs


def test_one_small_wheel_for_every_python(wheel):
    assert re.fullmatch(
        rf"limber_arm-{re.escape(__version__)}-py3-none-manylinux_2_35_\w+\.whl", wheel.name
    )
    assert wheel.stat().st_size < LARGEST_WHEEL


def test_it_is_the_same_each_time(wheel, tmp_path):
    again = release.build_wheel(tmp_path, ROOT / "build" / "dev")
    assert filecmp.cmp(wheel, again, shallow=False)


def test_it_holds_all_and_nothing_of_the_tree(wheel):
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        assert {name.removeprefix("limber/bin/") for name in names} >= PROGRAMS
        for needed in (
            "limber/lib/liblimber.so.0",
            "limber/share/limber/robots/openarm/robot.urdf",
            "limber/share/limber/scenarios/demo.yaml",
            "limber/share/limber/lcmtypes/joint_state_t.lcm",
            "limber/lcmtypes/joint_state_t.py",
            "limber/assets/page.js",
            "limber/include/limber/controller/laws/law.h",
            "limber/lib/cmake/limber/limberConfig.cmake",
        ):
            assert needed in names, needed
        text = "\n".join(names)
        carried = set(re.findall(r"\.libs/lib(.+)-[0-9a-f]{8}\.so", text))
        licences = set(re.findall(r"/licences/(.+)\.txt", text))
        assert carried == licences and "orocos-kdl" in licences
        assert not [name for name in names if "limber_qa" in name or "limber_lecture" in name]
        tree = str(ROOT).encode()
        assert not [name for name in names if tree in archive.read(name)]


def test_a_program_is_a_launcher_and_liblimber_shows_what_is_public_alone(installed):
    for name in PROGRAMS - {"limber-check"}:
        assert (installed.package / "bin" / name).stat().st_size < 40_000, name
    command = ["nm", "-D", "--defined-only", "-C", installed.package / "lib" / "liblimber.so.0"]
    shown = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert "limber::mit::" in shown and "limber_driver_main" in shown
    for hidden in ("limber::ArmDriver::", "limber::load_robot(", "limber::controller::TorqueCycle"):
        assert hidden not in shown


def test_the_demo_without_a_clock(installed):
    done = installed.call("limber", "demo", "--lockstep", "--seconds", "8", "--out", "out")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "How soft is the tip?" in done.stdout and "WRONG" not in done.stdout
    assert (installed.cwd / "out" / "demo.png").stat().st_size > 10_000


def test_a_log_has_the_bytes_of_the_tree(installed, tmp_path):
    """But for the folder of the arm, which stands in it."""
    robots = {"LIMBER_ROBOTS": str(ROOT / "robots")}
    done = installed.call("limber", "lab", "quick", "--record-plain", "--out", "bytes", **robots)
    assert done.returncode == 0, done.stdout + done.stderr
    own = installed.cwd / "bytes" / "run.lcmlog"
    lab = ROOT / "build" / "dev" / "bin" / "limber-lab"
    log = tmp_path / "run.lcmlog"
    scenario = ROOT / "scenarios" / "quick.yaml"
    subprocess.run([lab, scenario, "--log", log], check=True, capture_output=True)
    assert filecmp.cmp(own, log, shallow=False)


@pytest.mark.parametrize(
    "words",
    [
        ["limber", "doctor"],
        ["limber", "check", "openarm"],
        ["limber", "check", "scenarios/push.yaml"],
        ["limber", "--help"],
        ["python", "-c", "import limber; print(limber.Arm, limber.__version__)"],
        ["limber", "plot", "quick"],
        ["limber", "log", "info", "quick"],
    ],
)
def test_other_words_of_a_user(installed, words):
    installed.call("limber", "lab", "quick", "--out", "quick")
    done = installed.call(*words)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "./limber" not in done.stdout + done.stderr


def test_what_is_not_installed_is_named_with_its_command(installed):
    done = installed.call(
        "limber", "log", "convert", "quick", "--to", "mcap", "--out", "quick.mcap"
    )
    assert done.returncode == 3
    assert "pip install 'limber-arm[mcap]'" in done.stderr and "Traceback" not in done.stderr


def test_nothing_is_written_beside_the_package(installed):
    folder = installed.package
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*") if path.suffix != ".pyc"}
    installed.call("limber", "lab", "quick", "--out", "again")
    after = {path: path.stat().st_mtime_ns for path in folder.rglob("*") if path.suffix != ".pyc"}
    assert {path for path in after if path.is_file()} == {p for p in before if p.is_file()}
    tools = ("pip", "setuptools", "_distutils_hack", "pkg_resources")  # of every environment
    size = sum(
        path.stat().st_size
        for path in folder.parent.rglob("*")
        if path.suffix != ".pyc" and not path.relative_to(folder.parent).parts[0].startswith(tools)
    )
    assert size < LARGEST_INSTALLATION, f"{size / 1e6:.0f} MB"
