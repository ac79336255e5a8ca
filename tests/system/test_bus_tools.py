"""A simulated arm alone, a python-can client on its bus as told, and the tools beside it."""

import re
import signal
import subprocess
import sys
import threading
import time

import can
import pytest

from stack import BIN, ROOT

DISABLE = bytes.fromhex("FFFFFFFFFFFFFFFD")
SHOULDER = {"arbitration_id": 1, "is_extended_id": False, "data": DISABLE}


def wait_for(file, words: str) -> str:
    deadline = time.monotonic() + 20
    while words not in (text := file.read_text()):
        assert time.monotonic() < deadline, f"waited in vain for {words!r} in {text}"
        time.sleep(0.02)
    return text


@pytest.fixture
def start(tmp_path):
    """Starts a limber command, its output in a file; all are ended with the test."""
    started = []

    def run(name: str, *arguments: str):
        file = tmp_path / f"{name}.txt"
        with open(file, "wb") as output:
            process = subprocess.Popen(
                [sys.executable, "-m", "limber", *arguments],
                stdout=output,
                stderr=output,
                stdin=subprocess.DEVNULL,
            )
        started.append(process)
        return process, file

    yield run
    for process in started:
        process.kill()
        process.wait()


def end(process) -> int:
    process.send_signal(signal.SIGINT)
    return process.wait(10)


def test_a_client_joins_as_told_and_the_tools_see_it(start, tmp_path):
    sim, said = start("sim", "sim", "desktop2r")
    text = wait_for(said, "ode at")
    assert "shoulder" in text and "001" in text and "011" in text
    how = re.search(r'channel="([\d.]+)", port=(\d+)', text)
    log = tmp_path / "x.can.log"
    recorder, recording = start("record", "can", "record", str(log), "desktop2r")
    dump, dumped = start("dump", "can", "dump", "desktop2r")
    stats, counted = start("stats", "can", "stats", "desktop2r")
    wait_for(recording, "recording the buses")
    wait_for(counted, "counting until Ctrl-C")
    with can.Bus(
        interface="udp_multicast", channel=how[1], port=int(how[2]), hop_limit=0
    ) as client:
        for _ in range(40):  # the dump says nothing of its own until a frame comes
            client.send(can.Message(**SHOULDER))
            time.sleep(0.05)
    wait_for(dumped, "disabled, position")
    for process in (recorder, dump, stats):
        assert end(process) == 0
    assert "shoulder       command  disable" in dumped.read_text()
    assert f"{log}: 80 frames" in recording.read_text()
    lines = log.read_text().splitlines()
    assert len(lines) == 80
    assert re.fullmatch(r"\(\d+\.\d{6}\) desktop2r 001#FFFFFFFFFFFFFFFD", lines[0])
    assert abs(float(lines[0][1:].split(")")[0]) - time.time()) < 60
    assert re.search(r"001 +shoulder +command +40 ", counted.read_text())
    assert end(sim) == 0
    assert "ended at" in said.read_text()


def test_a_replayed_recording_is_answered(start, tmp_path):
    log = tmp_path / "commands.log"
    log.write_text(
        "(1.000000) desktop2r 001#FFFFFFFFFFFFFFFD\n(1.010000) desktop2r 002#FFFFFFFFFFFFFFFD\n"
        "(1.011000) desktop2r 011#0000000000000000\n"
    )
    sim, said = start("sim", "sim", "desktop2r", "--no-stand")
    assert "falls until" in wait_for(said, "ode at")
    answers = tmp_path / "answers.log"
    recorder, recording = start("record", "can", "record", str(answers), "desktop2r")
    wait_for(recording, "recording the buses")
    replay, sent = start("replay", "can", "replay", str(log), "desktop2r", "--only", "commands")
    assert replay.wait(10) == 0
    assert "2 frames sent, 1 left out, 0 refused" in sent.read_text()
    time.sleep(0.3)
    assert end(recorder) == 0 and end(sim) == 0
    ids = [line.split()[2].split("#")[0] for line in answers.read_text().splitlines()]
    assert sorted(ids) == ["001", "002", "011", "012"]


def test_a_driver_does_not_start_beside_another_master(start):
    _, said = start("sim", "sim", "desktop2r")
    how = re.search(r'channel="([\d.]+)", port=(\d+)', wait_for(said, "ode at"))
    stop = threading.Event()

    def command() -> None:
        with can.Bus(
            interface="udp_multicast", channel=how[1], port=int(how[2]), hop_limit=0
        ) as other:
            while not stop.wait(0.05):
                other.send(can.Message(**SHOULDER))

    master = threading.Thread(target=command)
    master.start()
    try:
        driver = subprocess.run(
            [str(BIN / "limber-driver"), "--robot", "desktop2r"],
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )
    finally:
        stop.set()
        master.join()
    assert driver.returncode == 2
    assert "another program commands shoulder (id 0x1 on virtual:desktop2r)" in driver.stderr


@pytest.mark.parametrize("wire", ["{loss: 0.001}", "{delay_s: 1.0e-5}", "true"])
def test_a_wire_that_real_time_has_not_is_told(tmp_path, wire):
    """Frames of a virtual bus arrive at once there, and all of them."""
    text = (ROOT / "scenarios" / "desktop2r_push.yaml").read_text()
    scenario = tmp_path / "push.yaml"
    scenario.write_text(f"{text}\nwire: {wire}\n")
    command = [BIN / "limber-sim", "--scenario", scenario, "--realtime", "--duration", "0.1"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    told = f"warning: {scenario}: wire: acts in lock step" in done.stdout + done.stderr
    assert told == (wire != "true")
