"""`limber log replay` on the wire: what is sent and when, and what stops it."""

import signal
import subprocess
import sys
import time

import lcm
import pytest

from limber import messages
from limber.log.reader import Log
from recorders import recording
from stack import USER_URL, Listener

SESSION = 77
PRIVATE = "udpm://239.255.76.67:7700?ttl=0"
SECONDS, RATE_HZ = 2.0, 200


def state(seq: int, session: int = SESSION) -> bytes:
    made = messages.message_class("joint_state_t")()
    made.seq, made.session = seq, session
    return made.encode()


@pytest.fixture
def log(tmp_path):
    return write(tmp_path / "run.lcmlog")


def write(path, last_s=None):
    """Two seconds of states, and a request each tenth; one state much later."""
    file = lcm.EventLog(str(path), "w")
    request = messages.message_class("mode_request_t")()
    for i in range(int(SECONDS * RATE_HZ)):
        stamp_us = 5_000_000 + i * 1_000_000 // RATE_HZ
        file.write_event(stamp_us, "JOINT_STATE", state(i))
        if i % 10 == 0:
            request.seq = i
            file.write_event(stamp_us, "MODE_REQUEST", request.encode())
    if last_s is not None:
        file.write_event(int(last_s * 1e6), "JOINT_STATE", state(400))
    file.close()
    return path


def replay(path, *options):
    command = [sys.executable, "-m", "limber", "replay", str(path), *options]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def numbers(raw: list[bytes]) -> list[int]:
    return [int(messages.view("joint_state_t", data)["seq"]) for data in raw]


def test_states_are_sent_in_order_and_requests_are_not(log):
    listener = Listener(USER_URL)
    out, errors = replay(log, "--speed", "4", "--from", "0.5", "--to", "1.5").communicate()
    time.sleep(0.2)
    listener.close()
    assert numbers(listener.raw["JOINT_STATE"]) == list(range(100, 301)), errors
    assert "MODE_REQUEST" not in listener.raw
    assert "not sent: MODE_REQUEST (40 messages): it commands" in out
    assert "sent 201 messages" in out


def test_it_takes_as_long_as_the_recording(log):
    """At the least: a machine that is busy is slower, never faster."""
    listener = Listener(USER_URL)
    heard_s = []
    listener.lcm.subscribe("JOINT_STATE", lambda *_: heard_s.append(time.monotonic()))
    replay(log, "--to", "1").communicate()
    time.sleep(0.2)
    listener.close()
    assert heard_s[-1] - heard_s[0] > 0.95


def test_commands_under_another_name_and_on_an_address_of_their_own(log):
    user, private = Listener(USER_URL, "OLD_MODE_REQUEST"), Listener(PRIVATE)
    replay(log, "--speed", "20", "--commands-as", "OLD_").communicate()
    time.sleep(0.3)
    assert len(user.raw["OLD_MODE_REQUEST"]) == 40 and "MODE_REQUEST" not in user.raw
    replay(log, "--speed", "20", "--with-commands", "--url", PRIVATE).communicate()
    time.sleep(0.3)
    user.close()
    private.close()
    assert len(private.raw["MODE_REQUEST"]) == 40 and "MODE_REQUEST" not in user.raw


def test_a_long_pause_is_shortened_and_told(tmp_path):
    log = write(tmp_path / "run.lcmlog", last_s=86_400)
    out, _ = replay(log, "--speed", "20").communicate(timeout=300)
    assert "a pause of 86393 s in the log was shortened to 1 s" in out
    assert "sent 401 messages" in out


def test_refused_where_a_stack_runs(stack, log):
    stack.start_all()
    before = stack.user.count("JOINT_STATE")
    process = replay(log)
    out, errors = process.communicate(timeout=300)
    stack.until(lambda: stack.user.count("JOINT_STATE") > before, 5, "a state of the stack")
    assert process.returncode == 3 and out == ""
    assert "a stack, or another replay, is running there" in errors
    sessions = {
        int(messages.view("joint_state_t", data)["session"])
        for data in stack.user.raw["JOINT_STATE"][before:]
    }
    assert sessions and SESSION not in sessions, "not one message was sent"


def test_stopped_by_a_driver_that_starts_meanwhile(log):
    process = replay(log, "--speed", "0.1")
    line = lcm.LCM(USER_URL)
    heard = []
    line.subscribe("JOINT_STATE", lambda *_: heard.append(1))
    while not heard and process.poll() is None:
        line.handle_timeout(100)
    for i in range(2000):
        line.publish("JOINT_STATE", state(i, session=SESSION + 1))
        time.sleep(0.01)
        if process.poll() is not None:
            break
    _, errors = process.communicate(timeout=300)
    assert process.returncode == 3
    assert "a driver has started on this address: the replay is stopped" in errors


def test_another_programs_long_message_comes_whole(tmp_path):
    """200 kB, in fragments: to LCM's own receiver, and to limber-record."""
    picture = bytes(range(256)) * 800
    path = tmp_path / "long.lcmlog"
    file = lcm.EventLog(str(path), "w")
    file.write_event(1_000_000, "JOINT_STATE", state(0))
    file.write_event(1_000_001, "CAMERA", picture)
    file.close()
    heard = []
    line = lcm.LCM(USER_URL)
    line.subscribe("CAMERA", lambda _, data: heard.append(data))
    with recording(tmp_path / "again.lcmlog") as recorder:
        out, errors = replay(path, "--channels", "CAMERA").communicate(timeout=300)
        while line.handle_timeout(500):
            pass
        recorder.send_signal(signal.SIGINT)
        assert recorder.wait(timeout=300) == 0
    assert heard == [picture], out + errors
    assert Log(tmp_path / "again.lcmlog").raw("CAMERA") == [picture]
