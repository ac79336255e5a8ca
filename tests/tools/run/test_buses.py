"""Runs on the kernel's CAN: never in a private network, never without a warning."""

import io

import pytest
from rich.console import Console

from limber.errors import InputError, RunError
from limber.live import network
from limber.model.robot import load_robot
from limber.run import buses, commands, runner
from limber.run.options import RunOptions
from limber.run.pace import Pace


@pytest.fixture
def real_arm(tmp_path):
    """A scenario for desktop2r with the one word changed that leaves the simulator."""
    from limber.paths import robot_folder

    source = robot_folder("desktop2r")
    arm = tmp_path / "arm"
    arm.mkdir()
    text = (source / "robot.yaml").read_text().replace("virtual:desktop2r", "socketcan:can0")
    (arm / "robot.yaml").write_text(text)
    (arm / "robot.urdf").write_text((source / "robot.urdf").read_text())
    scenario = tmp_path / "hold.yaml"
    scenario.write_text(f"format: limber-scenario/1\nrobot: {arm}\nduration_s: 1\n")
    return scenario


@pytest.fixture
def started(monkeypatch):
    """Which of the two ways into a network was taken, in place of the run."""
    ways = []
    monkeypatch.setattr(network, "ensure_multicast", lambda private: ways.append("may be private"))
    monkeypatch.setattr(runner, "run", lambda *_: ways.append("run"))
    monkeypatch.setattr(commands, "report", lambda *_: 0)
    monkeypatch.setattr(network, "is_private", lambda: False)
    return ways


def run(scenario, tmp_path, **options) -> str:
    console = Console(file=io.StringIO(), width=200)
    commands.run(scenario, RunOptions(out=tmp_path / "out", **options), console)
    return console.file.getvalue()


def test_addresses_are_robot_yamls_unless_given():
    robot = load_robot("iiwa14")
    assert set(buses.addresses(robot, ())) == {"shoulder", "wrist"}
    chosen = buses.addresses(robot, ("wrist=socketcan:can1",))
    assert chosen["wrist"] == "socketcan:can1" and chosen["shoulder"].startswith("virtual:")
    assert buses.real(chosen) == ["socketcan:can1"]
    with pytest.raises(InputError, match="shoulder, wrist"):
        buses.addresses(robot, ("hand=virtual:x",))


@pytest.mark.parametrize("with_simulator", [False, True])
def test_a_real_bus_of_robot_yaml_is_told(real_arm, started, monkeypatch, tmp_path, with_simulator):
    monkeypatch.setattr(network, "multicast_works", lambda: True)
    said = run(real_arm, tmp_path, with_simulator=with_simulator)
    assert "whatever is on socketcan:can0 will move" in said
    assert started == ["run"]


def test_without_a_multicast_route_it_is_an_error_with_the_commands(
    real_arm, started, monkeypatch, tmp_path
):
    monkeypatch.setattr(network, "multicast_works", lambda: False)
    with pytest.raises(RunError) as refused:
        run(real_arm, tmp_path, with_simulator=False)
    assert "ip link set lo multicast on" in str(refused.value)
    assert "ip route add 224.0.0.0/4 dev lo" in str(refused.value)
    with pytest.raises(InputError, match="--private"):
        run(real_arm, tmp_path, with_simulator=False, private_network=True)
    assert started == []


def test_virtual_buses_may_go_to_a_private_network(real_arm, started, tmp_path):
    said = run(real_arm, tmp_path, with_simulator=False, buses=("arm=virtual:x",))
    assert started == ["may be private", "run"]
    assert "no simulator: whatever is on the bus will move" in said
    assert "will move" not in run(real_arm, tmp_path, buses=("arm=virtual:x",))


def test_rate_and_frames_reach_the_programs(real_arm, tmp_path):
    from limber.model.scenario import load_scenario

    scenario = load_scenario(real_arm)
    options = RunOptions(rate_hz=400.0, record_can=True)
    made = runner._commands(scenario, tmp_path, options, Pace.LOCKSTEP, recorded=True)
    for name in ("limber-sim", "limber-driver"):
        words = made[name]
        assert words[words.index("--rate") + 1] == "400"
    driver = made["limber-driver"]
    assert driver[driver.index("--cycles") + 1] == "400"
    assert made["limber-can"][1] == "record"
    assert list(made).index("limber-can") < list(made).index("limber-driver")
    plain = runner._commands(scenario, tmp_path, RunOptions(), Pace.LOCKSTEP, recorded=True)
    assert "limber-can" not in plain and "--rate" not in plain["limber-driver"]
