"""The way to a real arm as the README has it: one word changed, and --no-sim.

The arm is the simulator in a network of its own, behind a cable from can0 to can0: nothing but CAN
frames connects the two.
"""

import configparser
import os
import re
import shlex
import shutil
import subprocess
import time
from pathlib import Path

import pytest
import yaml

from limber.lcmtypes.controller_status_t import controller_status_t as Status
from limber.lcmtypes.joint_state_t import joint_state_t as State
from slow_arm import slow_arm
from stack import BIN, ROOT

STOOD_STILL = re.compile(r"^(driver|controller)\.\w+ at .* s: limber-\w+ stood still", re.MULTILINE)
CABLE = "ip link add can0 type vxcan peer name can0 netns {pid}"
LOOPBACK = "ip link set lo up; ip link set lo multicast on; ip route add 224.0.0.0/4 dev lo"


def sh(command: str) -> None:
    subprocess.run(command, shell=True, check=True, timeout=30)


def network_of(pid: int) -> str:
    return os.readlink(f"/proc/{pid}/ns/net")


@pytest.fixture
def folder(stack):
    """my_arm and my_scenario.yaml; the arm has eight seconds to become ready, which takes four."""
    bus = {"name": "arm", "can": "virtual:my_arm", "fd": False, "bitrate_bps": 1_000_000}
    slow_arm(stack.directory / "my_arm", name="my_arm", buses=[bus])
    scenario = {
        "format": "limber-scenario/1",
        "name": "my_scenario",
        "robot": "my_arm",
        "mode": "realtime",
        "duration_s": 12.0,
        "timeline": [{"at_s": 8.0, "mode": "hold"}, {"at_s": 9.0, "mode": "active"}],
    }
    (stack.directory / "my_scenario.yaml").write_text(yaml.safe_dump(scenario), encoding="utf-8")
    return stack.directory


@pytest.fixture
def arm(folder):
    """The simulator, which keeps to its own end of the cable."""
    wait = "until ip link set can0 mtu 72 up 2>/dev/null; do sleep 0.1; done"
    program = f"{BIN}/limber-sim --robot {folder}/my_arm --realtime --bus arm=socketcan:can0"
    command = ["unshare", "-n", "sh", "-c", f"{LOOPBACK}; {wait}; exec {program}"]
    with open(folder / "arm.log", "w", encoding="utf-8") as log:
        process = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT)
        while network_of(process.pid) == network_of(os.getpid()):
            time.sleep(0.01)
        sh(CABLE.format(pid=process.pid) + " && ip link set can0 mtu 72 up")
        yield process
        process.kill()
        process.wait()
        subprocess.run("ip link del can0", shell=True, check=False, capture_output=True)


def limber(folder, *arguments: str) -> subprocess.CompletedProcess:
    command = [str(ROOT / ".venv" / "bin" / "limber"), *arguments]
    return subprocess.run(
        command, cwd=folder, capture_output=True, text=True, timeout=200, check=False
    )


def change_the_word(folder) -> None:
    file = folder / "my_arm" / "robot.yaml"
    text = file.read_text(encoding="utf-8")
    assert text.count("virtual:my_arm") == 1
    file.write_text(text.replace("virtual:my_arm", "socketcan:can0"), encoding="utf-8")


def test_the_readmes_commands(folder, arm):
    """Once more, twice at most, if the run's own verdict is that this machine stood still."""
    change_the_word(folder)
    for out in ("first", "second", "third"):
        run = limber(folder, "run", "my_scenario.yaml", "--no-sim", "--out", out)
        said = run.stdout + run.stderr
        if run.returncode == 0 or not STOOD_STILL.search(said):
            break
    assert "whatever is on socketcan:can0 will move" in said
    assert "private network" not in said
    assert arm.poll() is None
    assert run.returncode == 0, said + (folder / "arm.log").read_text()
    assert (folder / out / "run.lcmlog.zst").exists()


def test_without_a_multicast_route_the_cure_is_named(folder, arm):
    change_the_word(folder)
    sh("ip route del 224.0.0.0/4 dev lo")
    try:
        run = limber(folder, "run", "my_scenario.yaml", "--no-sim", "--out", "out")
    finally:
        sh("ip route add 224.0.0.0/4 dev lo")
    assert run.returncode == 3
    assert "ip route add 224.0.0.0/4 dev lo" in run.stdout + run.stderr
    assert "private" not in run.stdout + run.stderr


def test_a_simulator_does_not_speak_on_a_real_bus(folder, arm):
    """Without --no-sim the word alone must not put a second arm on the bus."""
    change_the_word(folder)
    run = limber(folder, "run", "my_scenario.yaml", "--out", "out")
    assert run.returncode != 0
    assert "--no-sim" in run.stdout + run.stderr


def test_a_private_network_is_refused(folder, arm):
    change_the_word(folder)
    run = limber(folder, "run", "my_scenario.yaml", "--no-sim", "--private", "--out", "out")
    assert run.returncode == 2
    assert "--private" in run.stderr


# Of the drives, after a process has come back: a driver starts with them off; without a controller
# it has them hold.
STILL = {
    "driver": (State.DRIVE_OFF, State.DRIVE_FAULT),
    "controller": (State.DRIVE_HOLD, State.DRIVE_FAULT),
}


class Services:
    """What systemd makes of the units of `limber export service`, without its sandbox."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        (line,) = [
            line
            for line in (folder / "limber.tmpfiles.conf").read_text().splitlines()
            if line.startswith("d ")
        ]
        self.run_folder = Path(line.split()[1])
        self.run_folder.mkdir(mode=0o770)
        self.processes: dict[str, subprocess.Popen] = {}

    def start(self, role: str) -> None:
        unit = configparser.ConfigParser(interpolation=None, strict=False)
        unit.optionxform = str
        unit.read_string((self.folder / f"limber-{role}@.service").read_text())
        name, _, value = unit["Service"]["Environment"].partition("=")
        assert unit["Service"]["Restart"] == "on-failure"
        unit.read_string((self.folder / f"limber-{role}@my_arm.service.d/robot.conf").read_text())
        self.processes[role] = subprocess.Popen(
            shlex.split(unit["Service"]["ExecStart"]),
            env=os.environ | {name: value.replace("%i", "my_arm")},
        )

    def kill(self, role: str) -> None:
        self.processes[role].kill()
        self.processes[role].wait()

    def close(self) -> None:
        for process in self.processes.values():
            process.kill()
            process.wait()
        shutil.rmtree(self.run_folder)


def test_services_that_die_come_back_without_motion(folder, arm, stack):
    change_the_word(folder)
    written = limber(folder, "service", "my_arm", "--out", "service")
    assert written.returncode == 0, written.stderr
    services = Services(folder / "service")
    try:
        for role in ("driver", "controller"):
            services.start(role)
        stack.until(lambda: stack.mode == Status.MODE_IDLE, 30, "IDLE after the start")
        stack.bring_to(Status.MODE_HOLD)
        for role in ("driver", "controller"):
            services.kill(role)
            services.start(role)
            still = STILL[role]
            stack.until(
                lambda still=still: stack.state.drive_state in still, 30, f"the {role}'s restart"
            )
            time.sleep(1.0)
            assert stack.mode in (Status.MODE_IDLE, Status.MODE_INIT, Status.MODE_FAULT)
            assert stack.state.drive_state in still
            stack.acknowledge()
            stack.bring_to(Status.MODE_HOLD)
    finally:
        services.close()
