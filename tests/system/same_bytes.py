"""Lock-step runs whose bytes are compared: the lab's, and those of three processes on some bus."""

import subprocess
from pathlib import Path

import lcm
import yaml

from stack import BIN, ROOT

CHANNELS = (
    "JOINT_STATE",
    "JOINT_TORQUE",
    "SIM_TRUTH",
    "CONTROLLER_STATUS",
    "DRIVER_STATUS",
    "ROBOT_INFO",
    "REQUEST_ANSWER",
    "HAND_STATE",
    "HAND_TRUTH",
)


def shipped() -> list[str]:
    """All scenarios that end by themselves."""
    return sorted(path.stem for path in (ROOT / "scenarios").glob("*.yaml") if path.stem != "ready")


def shortened(name: str, seconds: float, folder: Path) -> Path:
    """A shipped scenario's beginning, without what it measures."""
    scenario = yaml.safe_load((ROOT / "scenarios" / f"{name}.yaml").read_text(encoding="utf-8"))
    scenario.pop("measure", None)
    scenario["duration_s"] = seconds
    scenario["timeline"] = [e for e in scenario.get("timeline", []) if e["at_s"] < seconds]
    path = folder / f"{name}.yaml"
    path.write_text(yaml.safe_dump(scenario), encoding="utf-8")
    return path


def payloads(log: Path) -> dict[str, list[bytes]]:
    found: dict[str, list[bytes]] = {channel: [] for channel in CHANNELS}
    for event in lcm.EventLog(str(log)):
        if event.channel in found:
            found[event.channel].append(event.data)
    return found


def of_the_lab(scenario: Path, out: Path) -> dict[str, list[bytes]]:
    log = out / "lab.lcmlog"
    subprocess.run(
        [str(BIN / "limber-lab"), str(scenario), "--log", str(log)], check=True, timeout=300
    )
    return payloads(log)


def of_three_processes(
    scenario: Path, out: Path, *options: str, pace: tuple[str, ...] = ("--lockstep",)
) -> dict[str, list[bytes]]:
    limber = str(ROOT / ".venv" / "bin" / "limber")
    command = [limber, "run", str(scenario), *pace, "--record-plain", "--out", str(out)]
    subprocess.run([*command, *options], check=True, timeout=300, stdin=subprocess.DEVNULL)
    return payloads(out / "run.lcmlog")


def expect_equal(run: dict[str, list[bytes]], lab: dict[str, list[bytes]], where: str) -> None:
    assert len(lab["JOINT_STATE"]) == len(lab["JOINT_TORQUE"]) >= 400
    for channel in CHANNELS:
        assert len(run[channel]) == len(lab[channel]), f"{where}, {channel}"
        for index, (ours, theirs) in enumerate(zip(run[channel], lab[channel], strict=True)):
            assert ours == theirs, f"{where} differs from the lab in {channel} number {index}"
