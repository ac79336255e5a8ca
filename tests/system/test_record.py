"""The recorder against datagrams that are no messages."""

import signal
import socket
import subprocess
import time

import lcm

from limber.lcmtypes.mode_request_t import mode_request_t
from stack import BIN, USER_URL

GROUP = ("239.255.76.67", 7667)
# The header of a short LCM message, number 2, and a channel's name without its end.
ENDLESS_NAME = b"LC02" + (2).to_bytes(4, "big") + b"AB"


def test_a_broken_datagram_is_left_out(tmp_path):
    path = tmp_path / "run.lcmlog"
    output = tmp_path / "record.log"
    with (
        output.open("w") as log,
        subprocess.Popen(
            [str(BIN / "limber-record"), "--out", str(path)], stdout=log, stderr=log
        ) as recorder,
    ):
        while "recording" not in output.read_text():
            assert recorder.poll() is None, output.read_text()
            time.sleep(0.02)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
            for _ in range(3):
                sender.sendto(ENDLESS_NAME, GROUP)
        lcm.LCM(USER_URL).publish("MODE_REQUEST", mode_request_t().encode())
        time.sleep(0.3)
        recorder.send_signal(signal.SIGINT)
        assert recorder.wait(timeout=20) == 0, output.read_text()
    assert output.read_text().count("impossible size") == 1
    assert [event.channel for event in lcm.EventLog(str(path))] == ["MODE_REQUEST"]
