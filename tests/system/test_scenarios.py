"""Shipped scenarios end to end, as a user starts them: exit status, summary, log, picture."""

import json
import re
import signal
import subprocess
import time

import pytest

from stack import ROOT

LIMBER = str(ROOT / ".venv/bin/limber")
TABLE = re.compile(r"^```\n(along .*?)^```", re.DOTALL | re.MULTILINE)  # README's, of the demo
MOST_IN_A_LOG_bytes = 1200  # of a cycle, compressed


def limber(*arguments: str, timeout_s: float = 300, unprivileged: bool = False):
    command = [LIMBER, *arguments]
    if unprivileged:  # without the right to SCHED_FIFO and locked memory
        command = ["prlimit", "--rtprio=0", "--memlock=65536", "setpriv", *DROP, *command]
    return subprocess.run(
        command,
        cwd=ROOT,
        timeout=timeout_s,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )


DROP = ["--bounding-set=-sys_nice,-ipc_lock", "--inh-caps=-sys_nice,-ipc_lock"]


def numbers(folder) -> dict[str, dict]:
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    for result in summary["results"]:
        assert {"name", "value", "unit", "expected", "tolerance", "pass"} <= result.keys()
    return {result["name"]: result for result in summary["results"]}


@pytest.mark.lockstep
@pytest.mark.parametrize(
    "name",
    [
        "push",
        "push_joint",
        "desktop2r_push",
        "planar2r_push",
        "ideal7_push",
        "iiwa14_push",
        "panda_push",
        "baxter_push",
        "edulite_a3_push",
        "yam_push",
        "trlc_dk1_push",
        "rebot_b601_dm_push",
        "axol_push",
        "desktop2r_ak_push",
        "desktop2r_odrive_push",
    ],
)
def test_stiffness_without_friction(name, tmp_path):
    """Two per cent of what was asked, in every direction (the scenario's own tolerance)."""
    done = limber("lab", f"scenarios/{name}.yaml", "--out", str(tmp_path / "out"))
    assert done.returncode == 0, done.stdout + done.stderr
    found = numbers(tmp_path / "out")
    judged = [r for n, r in found.items() if n.startswith("stiffness")]
    assert len(judged) >= 4
    for result in judged:
        assert result["pass"] is True, result
        if result["expected"]:
            assert abs(result["value"] / result["expected"] - 1) <= 0.02, result
    size_bytes = (tmp_path / "out" / "run.lcmlog.zst").stat().st_size
    assert size_bytes <= MOST_IN_A_LOG_bytes * found["cycles"]["value"]


@pytest.mark.lockstep
def test_demo_in_lock_step(tmp_path):
    out = tmp_path / "out"
    done = limber("demo", "--lockstep", "--no-watch", "--out", str(out))
    assert done.returncode == 0, done.stdout + done.stderr
    shown = [line.split() for line in done.stdout.splitlines()]
    table = TABLE.search((ROOT / "README.md").read_text(encoding="utf-8"))[1]
    for line in table.splitlines():
        assert line.split() in shown, f"README.md: {line}\n{done.stdout}"
    found = numbers(out)
    assert found["cycles"]["value"] == 26000
    assert 5 < found["peak contact force"]["value"] < 40
    for axis in ("+x", "+y", "+z"):  # the last push along each: with dither
        felt = found[f"stiffness {axis}"]
        assert "dither" in felt["note"]
        assert abs(felt["value"] / 500 - 1) < 0.1, "what a hand feels of 500 N/m"
    assert (out / "demo.png").stat().st_size > 20_000
    assert (out / "run.lcmlog.zst").stat().st_size > 3_000_000


@pytest.mark.realtime
@pytest.mark.parametrize("unprivileged", [False, True])
def test_a_simulated_arm_in_real_time(tmp_path, unprivileged):
    """What this machine makes of it is told, never judged here."""
    out = tmp_path / "out"
    done = limber(
        "run",
        *("scenarios/quick.yaml", "--realtime", "--out", str(out)),
        unprivileged=unprivileged,
    )
    found = numbers(out)
    assert 0 < found["cycles"]["value"] <= 3500
    assert "late cycles" in found and "lateness, median" in found
    status = done.stdout + (out / "limber-driver.log").read_text(encoding="utf-8")
    assert ("NOT real-time" in status) == unprivileged or "granted" in status


def test_plain_lcm_logger_hears_a_run(tmp_path):
    """No type, no option: LCM's own logger on its default address."""
    log = tmp_path / "plain.lcmlog"
    logger = subprocess.Popen(
        [str(ROOT / ".venv/bin/lcm-logger"), str(log)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        done = limber("run", "scenarios/quick.yaml", "--out", str(tmp_path / "out"))
        time.sleep(1.0)  # the logger writes to disk now and then
    finally:
        logger.send_signal(signal.SIGINT)
        try:
            logger.wait(timeout=10)
        except subprocess.TimeoutExpired:
            logger.kill()
            logger.wait()
    import lcm

    channels = {event.channel for event in lcm.EventLog(str(log))}
    assert {"JOINT_STATE", "JOINT_TORQUE", "CONTROLLER_STATUS", "SIM_TRUTH"} <= channels, (
        done.stdout
    )
