"""Whatever a user mistypes: exit code 2, one line that says what is right, never a traceback."""

import os
import subprocess
import sys

import numpy as np
import pytest
from made_logs import records, write_log
from typer.main import get_command

from limber.cli.main import app, main

SCENARIO = "format: limber-scenario/1\nrobot: openarm\nduration_s: 1\n"

# arguments, what the line must say; {dir} is a folder with a good log, good.yaml and what is below
WRONG = [
    (["dmeo"], "Did you mean 'demo'"),
    (["--nonsense"], "No such option"),
    (["demo", "--seconds", "many"], "--seconds"),
    (["demo", "--seconds", "-3"], "--seconds"),
    (["demo", "--seconds", "nan"], "--seconds"),
    (["run"], "'scenario'"),
    (["run", "{dir}/missing.yaml"], "does not exist"),
    (["run", "{dir}"], "is a folder"),
    (["run", "{dir}/tabs.yaml"], "tabs.yaml"),
    (["run", "{dir}/unknown_robot.yaml"], "openarm"),
    (["run", "{dir}/unknown_key.yaml"], "colour"),
    (["run", "{dir}/good.yaml", "--lockstep=maybe"], "--lockstep"),
    (["run", "{dir}/good.yaml", "--bus", "arm"], "virtual:NAME"),
    (["run", "{dir}/good.yaml", "--bus", "leg=virtual:x"], "buses are arm"),
    (["run", "{dir}/good.yaml", "--bus", "arm=usb:x"], "socketcan:IFACE"),
    (["run", "{dir}/good.yaml", "--out", "{dir}/good.yaml"], "--out"),
    (["run", "{dir}/measure.yaml"], "stiffness, contact_force"),
    (
        ["run", "{dir}/measure_value.yaml"],
        "measure.stiffness: '2' is out of range; expected a number from 1e-06 to 1",
    ),
    (["lab", "{dir}/missing.yaml"], "does not exist"),
    (["lab", "{dir}/good.yaml", "extra"], "unexpected extra argument"),
    (["lab", "{dir}/good.yaml", "--out", "{dir}"], "holds a run already (run.lcmlog)"),
    (["measure", "{dir}/nowhere"], "summary.json"),
    (["check"], "'what'"),
    (["check", "unheard_of"], "planar2r"),
    (["check", "missing.urdf"], "does not exist"),
    (["check", "missing.yml"], "does not exist"),
    (["new"], "'urdf'"),
    (["new", "{dir}/arm.urdf"], "--drives"),
    (["new", "{dir}/arm.urdf", "--drives", "steam"], "moteus"),
    (["new", "{dir}/missing.urdf", "--drives", "damiao"], "does not exist"),
    (["new", "{dir}/arm.urdf", "--drives", "damiao"], "not an arm"),
    (["new", "{dir}/arm.urdf", "--drives", "damiao", "--name", "my arm"], "--name"),
    (["new", "{dir}/arm.urdf", "--drives", "damiao", "--out", "{dir}"], "exists already"),
    (["check", "openarm", "--base", "world"], "robot.yaml"),
    (["record"], "--out"),
    (["record", "--out", "{dir}/x.lcmlog", "--duration", "-1"], "--duration"),
    (["record", "--out", "/proc/nowhere/x.lcmlog"], "cannot be written"),
    (["ros2", "--rate", "nan"], "--rate"),
    (["ros2", "--interface", "eth77"], "no network interface 'eth77'"),
    (["record", "--out", "{dir}/x.lcmlog", "--task", "pick"], "--task belongs to --episodes"),
    (["record", "--out", "{dir}/x.lcmlog", "--episodes", "--task", "x" * 201], "200 bytes"),
    (["log", "episodes", "{dir}/run.lcmlog", "--drop", "1"], "episode 1: this log has 0"),
    (["log", "episodes", "{dir}/run.lcmlog", "--plot", "{dir}/x.jpg"], "end it in .png"),
    (["log", "episodes", "{dir}/run.lcmlog", "--plot", "{dir}/x.png"], "no episode to draw"),
    (["log", "info", "{dir}/missing.lcmlog"], "does not exist"),
    (["log", "info", "{dir}/good.yaml"], "no LCM event log"),
    (["log", "info", "{dir}/empty.lcmlog"], "empty"),
    (["log", "echo", "{dir}/run.lcmlog", "JOINT_SATE"], "JOINT_STATE"),
    (["log", "echo", "{dir}/run.lcmlog", "JOINT_STATE", "--field", "angle"], "theta"),
    (["log", "echo", "{dir}/run.lcmlog", "JOINT_STATE", "--count", "0"], "--count"),
    (["log", "echo", "{dir}/run.lcmlog", "JOINT_STATE", "--at", "1e9"], "no message from"),
    (["log", "convert", "{dir}/run.lcmlog", "--out", "{dir}/x.xlsx"], ".npz"),
    (["log", "convert", "{dir}/run.lcmlog"], "--to is missing: one of csv, parquet, mcap"),
    (["log", "convert", "{dir}/run.lcmlog", "--to", "xlsx"], "mcap"),
    (["log", "convert", "{dir}/run.lcmlog", "--to", "csv", "--out", "{dir}/x.csv"], "a folder"),
    (["log", "convert", "{dir}/run.lcmlog", "--to", "lcm"], "exists already"),
    (["log", "convert", "{dir}", "--to", "mcap", "--channels", "JOINT_SATE"], "JOINT_STATE"),
    (["log", "cut", "{dir}/run.lcmlog", "--out", "{dir}/x.mcap"], ".lcmlog"),
    (["log", "cut", "{dir}/run.lcmlog", "--out", "{dir}/run.lcmlog"], "exists already"),
    (["log", "cut", "{dir}", "--from", "9", "--out", "{dir}/x.lcmlog"], "ends after 0.019 s"),
    (["replay", "{dir}/missing.lcmlog"], "does not exist"),
    (["replay", "{dir}/run.lcmlog", "--speed", "0"], "--speed"),
    (["replay", "{dir}/run.lcmlog", "--from", "9"], "the log ends after 0.019 s"),
    (["replay", "{dir}/run.lcmlog", "--channels", "JOINT_SATE"], "JOINT_STATE"),
    (["replay", "{dir}/run.lcmlog", "--with-commands"], "give a port of its own with --url"),
    (["replay", "{dir}/run.lcmlog", "--url", "udpm://239.255.76.68:7668?ttl=0"], "arm plane"),
    (["log", "play", "{dir}/run.lcmlog"], "No such command 'play'"),
    (["plot", "{dir}/run.lcmlog", "--what", "jiont"], "joint, cartesian, torque, spring, timing"),
    (["plot", "{dir}/run.lcmlog", "--what", "torque"], "CONTROLLER_STATUS"),
    (["watch", "--robot", "openarm"], "No such option"),
    (["identify", "joints"], "'robot'"),
    (["identify", "joints", "unheard_of"], "planar2r"),
    (["identify", "joints", "openarm", "--angle", "0"], "--angle"),
    (["identify", "joints", "openarm", "--bus", "leg=virtual:x"], "buses are arm"),
    (["identify", "joints", "openarm", "--json", "nowhere/x.json"], "nowhere does not exist"),
    (["identify", "first-hour", "openarm", "--from", "lunch"], "wire, motors, zero, directions"),
    (["sweep"], "'what'"),
    (["sim"], "'robot'"),
    (["sim", "unheard_of"], "planar2r"),
    (["run", "{dir}/good.yaml", "--rate", "0"], "--rate"),
    (["doctor", "unheard_of"], "planar2r"),
    (["can", "dump", "unheard_of"], "planar2r"),
    (["motors", "scan"], "'bus'"),
    (["motors", "show", "can0"], "'motor'"),
    (["motors", "set-id", "virtual:nobody", "damiao_mit:1", "128"], "127"),
    (["motors", "zero", "can0"], "'motor'"),
    (["motors", "dump"], "'buses"),
    (["motors", "restore"], "'file'"),
    (["can", "dump", "--file", "{dir}/missing.log"], "does not exist"),
    (["can", "stats", "--duration", "-1"], "--duration"),
    (["can", "record"], "'file'"),
    (["can", "replay", "{dir}/missing.log"], "does not exist"),
    (["can", "replay", "{dir}/good.yaml", "--only", "errors"], "commands"),
    (["can", "dbc"], "'robot'"),
    (["identify", "friction"], "'runs'"),
    (["identify", "friction", "{dir}/run.lcmlog"], "--robot"),
    (["identify", "friction", "{dir}/run.lcmlog", "--robot", "openarm"], "never on"),
    (["identify", "motion", "--robot", "unheard_of"], "planar2r"),
    (["identify", "motion", "--poses", "1"], "--poses"),
    (["experiment", "run"], "'which'"),
    (["experiment", "run", "E99"], "E12"),
    (["experiment", "run", "all", "--jobs", "0"], "--jobs"),
    (["experiment", "report", "--out", "{dir}"], "experiment run all"),
    (["test", "everything"], "ctest"),
    (["bench", "faster"], "unexpected extra argument"),
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("cli")
    files = {
        "good.yaml": SCENARIO,
        "tabs.yaml": SCENARIO + "timeline:\n\t- nothing\n",
        "unknown_robot.yaml": SCENARIO.replace("openarm", "openleg"),
        "unknown_key.yaml": SCENARIO + "colour: red\n",
        "measure.yaml": SCENARIO + "measure: {stifness: 0.1}\n",
        "measure_value.yaml": SCENARIO + "measure: {stiffness: 2}\n",
        "arm.urdf": "<robot name='r'><link name='base'/></robot>",
        "empty.lcmlog": "",
    }
    for name, text in files.items():
        (made / name).write_text(text, encoding="utf-8")
    states = records("joint_state_t", 20, num_joints=7)
    states["time_ns"] = np.arange(20) * 1_000_000
    write_log(made / "run.lcmlog", {"JOINT_STATE": states})
    return made


@pytest.mark.parametrize(("arguments", "said"), WRONG, ids=lambda v: " ".join(v) if v else "")
def test_wrong_arguments(folder, arguments, said, monkeypatch, capsys):
    """In this process, which is quicker; test_as_a_program starts it as a user does."""
    monkeypatch.setattr(sys, "argv", ["limber", *(word.format(dir=folder) for word in arguments)])
    monkeypatch.chdir(folder)
    before = {path.name for path in folder.iterdir()}
    with pytest.raises(SystemExit) as ended:
        main()
    out, errors = capsys.readouterr()
    assert ended.value.code == 2, out + errors
    lines = errors.splitlines()
    assert len(lines) == 1, errors
    assert lines[0].startswith("limber: ")
    assert said in lines[0], lines[0]
    assert {path.name for path in folder.iterdir()} == before, "nothing is left behind"


@pytest.mark.parametrize("arguments", [["dmeo"], ["log", "info", "missing"], ["demo", "--out"]])
def test_as_a_program(limber, arguments):
    done = limber(*arguments)
    assert done.returncode == 2
    assert done.stdout == ""
    assert len(done.stderr.splitlines()) == 1


def test_unexpected_trouble_is_one_line_too(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["limber", "doctor"])
    monkeypatch.setattr("limber.doctor.machine.examine", lambda _robot: 1 // 0)
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 3
    assert capsys.readouterr().err.splitlines() == [
        "limber: ZeroDivisionError: integer division or modulo by zero (LIMBER_DEBUG=1 shows where)"
    ]


def test_log_commands(limber, folder):
    info = limber("log", "info", str(folder))
    assert info.returncode == 0, info.stderr
    assert "JOINT_STATE" in info.stdout and "20 messages" in info.stdout
    rate = limber("log", "rate", str(folder))
    assert "1000.000" in rate.stdout, rate.stdout
    echo = limber("log", "echo", str(folder), "JOINT_STATE", "--field", "seq", "--count", "3")
    assert echo.stdout.split() == ["0", "1", "2"]
    later = limber(
        "log", "echo", str(folder), "JOINT_STATE", "--field", "time_ns", "--at", "0.0075"
    )
    assert later.stdout.split() == ["8000000"]


def test_convert(limber, folder, tmp_path):
    assert limber("log", "convert", str(folder), "--out", str(tmp_path / "a.npz")).returncode == 0
    arrays = np.load(tmp_path / "a.npz")
    np.testing.assert_array_equal(arrays["JOINT_STATE.seq"], np.arange(20))
    assert arrays["JOINT_STATE.q"].shape == (20, 16)
    assert limber("log", "convert", str(folder), "--out", str(tmp_path / "csv")).returncode == 0
    table = np.genfromtxt(tmp_path / "csv" / "JOINT_STATE.csv", delimiter=",", names=True)
    np.testing.assert_array_equal(table["seq"], np.arange(20))
    assert "jointsjoint7q_rad" in table.dtype.names, table.dtype.names


def test_reader_that_goes_away_is_no_error(folder):
    command = f"{sys.executable} -m limber log echo {folder} JOINT_STATE --count 20 | head -1"
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False)
    assert done.stdout == "seq: 0\n"
    assert done.stderr == ""


def test_every_command_has_a_line_of_help(limber):
    """One sentence each, and `limber --help` lists them all."""
    shown = limber("--help").stdout
    commands = get_command(app).commands
    assert {"demo", "run", "lab", "send", "log", "dev", "lecture"} <= set(commands)
    for name, command in commands.items():
        assert name in shown
        assert command.help and command.help.endswith("."), name


def test_every_command_that_reads_logs_has_an_example():
    commands = get_command(app).commands
    logs = commands["log"].commands.values()
    for command in [*(each for each in logs if not hasattr(each, "commands")), commands["plot"]]:
        assert command.epilog.startswith("Example: limber "), command.name


def test_doctor_tells_level_and_cure(limber):
    done = limber("doctor")
    assert "multicast" in done.stdout and "SocketCAN" in done.stdout
    for line in done.stdout.splitlines():
        assert line.split()[0] in ("ok", "warn", "fail", "cure:"), line


def test_a_terminal_without_unicode_is_no_error():
    """The tables of results have a character that ASCII does not have."""
    environment = {**os.environ, "PYTHONUTF8": "0", "LC_ALL": "C"}
    command = [sys.executable, "-c", PRINT_UNICODE]
    done = subprocess.run(command, env=environment, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr
    assert b"300 ? 3" in done.stdout


PRINT_UNICODE = """
from limber.cli import main, options
main.app.command("unicode")(lambda: options.console.print("300 \\u00b1 3"))
import sys
sys.argv = ["limber", "unicode"]
main.main()
"""
