"""What a run writes nobody else may change, whatever the umask is; what may not be read or written
is named.
"""

import os
import shutil
import stat
import subprocess
from pathlib import Path

import pytest

from limber.black_box.boxes import kept_boxes
from stack import BIN, ROOT

LIMBER = str(ROOT / ".venv" / "bin" / "limber")
ROBOT = ROOT / "robots" / "desktop2r"
# Of root, who may read and write everything.
DROP = "-dac_override,-dac_read_search"

FAULT = """format: limber-scenario/1
robot: desktop2r
mode: realtime
duration_s: 4
timeline:
  - {at_s: 0.3, mode: hold}
  - {at_s: 0.8, fault: {joint: shoulder, kind: silent, for_s: 0.5}}
"""


def limber(*arguments, **options) -> subprocess.CompletedProcess:
    command = ["setpriv", f"--bounding-set={DROP}", f"--inh-caps={DROP}", LIMBER, *arguments]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=300, **options)


def open_to_all(folder: Path) -> list[Path]:
    found = [folder, *folder.rglob("*")]
    return [path for path in found if stat.S_IMODE(path.stat().st_mode) & stat.S_IWOTH]


def test_nobody_else_may_change_what_a_run_writes(tmp_path, monkeypatch):
    scenario, out, kept = tmp_path / "fault.yaml", tmp_path / "out", tmp_path / "kept"
    scenario.write_text(FAULT)
    monkeypatch.setenv("LIMBER_BLACK_BOXES", str(kept))
    done = limber("run", str(scenario), "--out", str(out), umask=0)
    assert (out / "run.lcmlog.zst").exists(), done.stderr
    assert {box.program for box in kept_boxes()} == {"driver", "controller", "sim"}
    done = limber("log", "convert", str(out), "--to", "csv", umask=0)
    assert done.returncode == 0, done.stderr
    assert limber("plot", str(out), umask=0).returncode == 0
    assert open_to_all(out) + open_to_all(kept) == []
    boxes = Path(f"/dev/shm/limber-{os.geteuid()}")
    assert stat.S_IMODE(boxes.stat().st_mode) == 0o700


def test_programs_alone_leave_nothing_for_all(tmp_path):
    log = tmp_path / "out" / "run.lcmlog"
    command = [BIN / "limber-can", "record", "desktop2r", "--out", log.with_suffix(".can.log")]
    log.parent.mkdir(mode=0o755)
    subprocess.run([*command, "--duration", "0.1"], check=True, timeout=300, umask=0)
    subprocess.run(
        [BIN / "limber-record", "--out", log, "--duration", "0.1"],
        check=True,
        timeout=300,
        umask=0,
    )
    assert len(list(log.parent.iterdir())) == 2
    assert open_to_all(log.parent) == []


@pytest.fixture
def arm(tmp_path):
    return Path(shutil.copytree(ROBOT, tmp_path / "arm"))


@pytest.mark.parametrize("name", ["robot.yaml", "robot.urdf"])
def test_a_description_that_may_not_be_read_is_named(arm, name):
    (arm / name).chmod(0)
    done = limber("check", str(arm))
    assert done.returncode == 2
    assert done.stdout + done.stderr == f"{arm / name}: cannot be read\n"


def test_a_log_that_may_not_be_read_is_named(tmp_path):
    log = tmp_path / "run.lcmlog"
    log.write_bytes(b"unreadable")
    log.chmod(0)
    for command in (("log", "info"), ("plot",), ("replay",)):
        done = limber(*command, str(tmp_path))
        assert done.stderr == f"limber: {log}: Permission denied\n", command


def test_a_folder_that_may_not_be_written_is_named(tmp_path):
    folder = tmp_path / "closed"
    folder.mkdir(mode=0o555)
    scenario = "scenarios/quick.yaml"
    for command in (("lab", scenario), ("run", scenario), ("record",)):
        out = folder / "run.lcmlog" if command == ("record",) else folder / "new"
        done = limber(*command, "--out", str(out))
        assert done.returncode == 2, command
        assert str(folder) in done.stderr and "cannot be written (Permission denied)" in done.stderr
        assert "Traceback" not in done.stderr
