"""`limber monitor --foxglove` beside the real processes, read by a client of Foxglove's protocol.

Protocol: https://github.com/foxglove/ws-protocol/blob/main/docs/spec.md (the client is ours).
"""

import base64
import json
import socket
import struct
import subprocess
import sys
from contextlib import contextmanager

import numpy as np
import pytest

from limber.messages import views

pytest.importorskip("foxglove", reason="comes with ./limber test")
import websockets
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from websockets.sync.client import connect

MESSAGE = struct.Struct("<BIQ")  # opcode, subscription, time in ns
DATA = 1
PROTOCOL = websockets.Subprotocol("foxglove.sdk.v1")
WANTED = ("/JOINT_STATE", "/CONTROLLER_STATUS", "/tip", "/joint_states")


@contextmanager
def bridge():
    """Its address."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    words = [sys.executable, "-m", "limber", "monitor", "--foxglove", "--port", str(port)]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as process:
        try:
            told = process.stdout.readline()
            assert f"openarm: Foxglove, Open connection, ws://127.0.0.1:{port}" in told, told
            yield f"ws://127.0.0.1:{port}"
        finally:
            process.terminate()
            left = process.stdout.read()
    assert process.returncode == 0 and "messages received, 0 lost" in left, left


def advertised(viewer) -> dict[str, dict]:
    """Channels by topic, once all that are wanted are there."""
    found: dict[str, dict] = {}
    while not set(WANTED) <= set(found):
        text = viewer.recv(timeout=20)
        told = json.loads(text) if isinstance(text, str) else {}
        found |= {each["topic"]: each for each in told.get("channels", [])}
    return found


def message_type(channel: dict):
    """From the schema that the server gave."""
    files = descriptor_pb2.FileDescriptorSet.FromString(base64.b64decode(channel["schema"]))
    pool = descriptor_pool.DescriptorPool()
    for file in files.file:
        pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(channel["schemaName"]))


def collect(viewer, channels: dict[str, dict], states: int) -> dict[str, list[tuple[int, bytes]]]:
    """Subscribes, until so many JOINT_STATE have come."""
    numbers = dict(enumerate(WANTED))
    wanted = [{"id": n, "channelId": channels[topic]["id"]} for n, topic in numbers.items()]
    viewer.send(json.dumps({"op": "subscribe", "subscriptions": wanted}))
    found: dict[str, list[tuple[int, bytes]]] = {topic: [] for topic in WANTED}
    while len(found["/JOINT_STATE"]) < states:
        data = viewer.recv(timeout=20)
        if isinstance(data, bytes) and data[0] == DATA:
            _, number, time_ns = MESSAGE.unpack_from(data)
            found[numbers[number]].append((time_ns, data[MESSAGE.size :]))
    return found


def records(stack, channel: str, type_name: str) -> np.ndarray:
    """What a listener of the user plane has received."""
    return views(type_name, list(stack.user.raw[channel]))


def test_every_message_arrives_with_its_numbers(stack):
    stack.start_all()
    stack.until(lambda: stack.user.count("ROBOT_INFO") > 0, 10, "the stack")
    with bridge() as url, connect(url, subprotocols=[PROTOCOL], max_size=None) as viewer:
        channels = advertised(viewer)
        found = collect(viewer, channels, 2000)
    kind = message_type(channels["/JOINT_STATE"])
    states = [kind.FromString(data) for _, data in found["/JOINT_STATE"]]
    numbers = [state.seq for state in states]
    assert numbers == list(range(numbers[0], numbers[0] + len(states))), "each once, in order"
    sent = {row["seq"]: row for row in records(stack, "JOINT_STATE", "joint_state_t")}
    names = [joint["name"] for joint in json.loads(found["/joint_states"][0][1])["joints"]]
    for state in states[::100]:
        row = sent[state.seq]
        values = [getattr(state.joints, name).q_rad for name in names]
        assert values == row["q"][: len(names)].tolist()

    status = records(stack, "CONTROLLER_STATUS", "controller_status_t")
    tips = {tuple(row["p_BT"].tolist()) for row in status}
    pose = json.loads(found["/tip"][-1][1])["pose"]["position"]
    assert (pose["x"], pose["y"], pose["z"]) in tips
    for topic, messages in found.items():
        times_ns = [time_ns for time_ns, _ in messages]
        assert times_ns == sorted(times_ns), topic


def test_a_port_that_is_taken_is_named():
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = str(taken.getsockname()[1])
        words = [sys.executable, "-m", "limber", "monitor", "--foxglove", "--robot", "planar2r"]
        done = subprocess.run(
            [*words, "--port", port], capture_output=True, text=True, check=False, timeout=60
        )
    assert done.returncode == 3, done
    assert f"limber: port {port} of 127.0.0.1" in done.stderr and "another --port" in done.stderr
