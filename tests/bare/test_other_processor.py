"""limber for aarch64, made on this machine and run by an emulator: unit tests, and the wheel in a
Debian 12 of that processor.

The kernel's numbers are the same bits. A run is not: KDL, urdfdom and ODE are the distribution's,
whose aarch64 builds fuse multiply-adds. The emulator lacks socket options that the processes of
`limber run` need: they want a board.
"""

import re
import shutil
from functools import partial
from pathlib import Path

import lcm
import numpy as np
import pytest
from test_bare_systems import MIRROR, SUITES, call, download

from limber.lcmtypes.sim_truth_t import sim_truth_t
from limber.paths import ROOT
from limber_qa import cross, release

UNIT_TESTS = ("dynamics", "gate", "protocols", "robots", "scenarios", "sim", "controller")
DIGEST = re.compile(r'name="digest" value="(\d+)"')
SYSTEM = "bash,coreutils,dash,libstdc++6,python3-venv"


BUILD = ROOT / "build" / "aarch64"  # stays, with what it is compiled against


@pytest.fixture(scope="module")
def sysroot() -> Path:
    for program in ("qemu-aarch64-static", "mmdebstrap", cross.COMPILER):
        if shutil.which(program) is None:
            pytest.skip(f"no {program}")
    folder = BUILD / "sysroot"
    if not folder.exists():
        cross.make_sysroot(folder)
    return folder


@pytest.mark.timeout(3600)
def test_the_unit_tests(sysroot, tmp_path):
    words = [f"{name}={value}" for name, value in cross.environment(sysroot).items()]
    run = partial(call, "env", *words)
    run("cmake", "-S", ROOT, "-B", BUILD / "tree", "-G", "Ninja")
    run("ninja", "-C", BUILD / "tree", *(f"test_{name}" for name in UNIT_TESTS))
    tests = "|".join(f"^{name}" for name in UNIT_TESTS)
    shown = run("ctest", "--test-dir", BUILD / "tree", "-R", tests, "--no-tests=error")
    assert "100% tests passed" in shown
    kernel = "tests/test_dynamics"
    report = tmp_path / "dynamics.xml"
    options = ["--gtest_filter=Levels.GiveTheSameBits", f"--gtest_output=xml:{report}"]
    digests = set()
    for command in (
        [ROOT / "build/dev" / kernel],
        [*cross.emulator(sysroot), BUILD / "tree" / kernel],
    ):
        call(*command, *options)
        digests.add(DIGEST.search(report.read_text())[1])
    assert len(digests) == 1


@pytest.mark.timeout(3600)
def test_the_wheel(sysroot, tmp_path):
    wheel = release.build_wheel(tmp_path, sysroot=sysroot)
    assert wheel.name.endswith("-py3-none-manylinux_2_35_aarch64.whl")
    assert wheel.stat().st_size < 6_000_000
    system = tmp_path / "system"
    debian = ["mmdebstrap", "--variant=extract", "--architectures=arm64", f"--include={SYSTEM}"]
    call(*debian, "bookworm", system, *filter(None, [MIRROR]))
    download(wheel, system / "wheels", SUITES["bookworm"], cross.MACHINE)
    inside = ["unshare", "-U", "-r", "-m", "-p", "-f", "-n", "--mount-proc"]
    script = Path(__file__).with_name("in-emulated-system")
    call(*inside, script, system)
    log = tmp_path / "run.lcmlog"
    lab = ROOT / "build" / "dev" / "bin" / "limber-lab"
    call(lab, ROOT / "scenarios/quick.yaml", "--log", log)
    here, there = (truth(path) for path in (log, system / "root" / "quick" / "run.lcmlog"))
    assert len(here) == len(there) == 3000
    # 1.5e-15 after a step; encoders and drives count the same, so it hardly grows.
    assert np.abs(here - there).max() < 1e-9


def truth(log: Path) -> np.ndarray:
    """Joints at each ms, rad."""
    states = (
        sim_truth_t.decode(event.data)
        for event in lcm.EventLog(str(log))
        if event.channel == "SIM_TRUTH"
    )
    return np.array([state.q[: state.num_joints] for state in states])
