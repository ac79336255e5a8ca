"""Lock step: three processes on the virtual bus and the lab give the same bytes, every time."""

import subprocess
from pathlib import Path

import lcm
import pytest

from stack import BIN, ROOT


def payloads(log: Path) -> dict[str, list[bytes]]:
    found: dict[str, list[bytes]] = {"JOINT_STATE": [], "JOINT_TORQUE": []}
    for event in lcm.EventLog(str(log)):
        if event.channel in found:
            found[event.channel].append(event.data)
    return found


def three_processes(scenario: Path, out: Path) -> dict[str, list[bytes]]:
    command = [
        str(ROOT / ".venv/bin/limber"),
        "run",
        str(scenario),
        "--lockstep",
        "--out",
        str(out),
    ]
    subprocess.run(command, check=True, timeout=300, stdin=subprocess.DEVNULL)
    return payloads(out / "run.lcmlog")


@pytest.mark.parametrize("name", ["quick", "planar2r_push"])
def test_same_bytes(name, tmp_path):
    scenario = ROOT / "scenarios" / f"{name}.yaml"
    log = tmp_path / "lab.lcmlog"
    subprocess.run(
        [str(BIN / "limber-lab"), str(scenario), "--log", str(log)], check=True, timeout=300
    )
    lab = payloads(log)
    assert len(lab["JOINT_STATE"]) > 1000
    assert len(lab["JOINT_STATE"]) == len(lab["JOINT_TORQUE"])
    for attempt in ("first", "second"):
        run = three_processes(scenario, tmp_path / attempt)
        for channel in ("JOINT_STATE", "JOINT_TORQUE"):
            assert len(run[channel]) == len(lab[channel]), f"{attempt} run, {channel}"
            for index, (ours, theirs) in enumerate(zip(lab[channel], run[channel], strict=True)):
                assert ours == theirs, (
                    f"{attempt} run differs from the lab in {channel} number {index}"
                )
