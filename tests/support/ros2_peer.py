"""The other end of `limber export ros2`, in a process of its own, and what has to hold for any."""

import json
import subprocess
import sys
import threading
import time
from collections import defaultdict
from contextlib import contextmanager

import numpy as np
from processes import started

from limber.live.arm_errors import NoStackError
from limber.model.rotations import matrix_of

LONG_S = 200.0  # on a machine that is busy elsewhere
PUSH_N = np.array([3.0, 4.0, 0.0])


class Peer:
    """A program that prints each message it gets as a line of JSON, `[topic, message]`, and takes
    such lines with /limber/goal_pose, /limber/stiffness, and `["?", topic]`: the subscribers that
    it knows of.
    """

    def __init__(self, process: subprocess.Popen) -> None:
        self._process = process
        self.heard: dict[str, list] = defaultdict(list)
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    def _read(self) -> None:
        for line in self._process.stdout:
            topic, message = json.loads(line)
            self.heard[topic].append(message)

    def send(self, topic: str, message) -> None:
        self._process.stdin.write(json.dumps([topic, message]) + "\n")
        self._process.stdin.flush()

    def subscribers(self, topic: str) -> int:
        count = len(self.heard["?"])
        self.send("?", topic)
        until(lambda: len(self.heard["?"]) > count, "an answer of the peer")
        return self.heard["?"][-1]

    def newest(self, topic: str):
        until(lambda: self.heard[topic], f"a message on {topic}")
        return self.heard[topic][-1]

    def next(self, topic: str, count: int = 1):
        """The newest, after so many more."""
        end = len(self.heard[topic]) + count
        until(lambda: len(self.heard[topic]) >= end, f"{count} messages on {topic}")
        return self.heard[topic][-1]

    def status(self, name: str):
        found = self.newest("/diagnostics")["status"]
        return next((each for each in found if each["name"] == f"limber: {name}"), None)


def until(condition, what: str) -> None:
    end_s = time.monotonic() + LONG_S
    while not condition():
        assert time.monotonic() < end_s, f"waited {LONG_S} s in vain for {what}"
        time.sleep(0.02)


@contextmanager
def peer(*command):
    with started([*command], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        yield Peer(process)
        process.stdin.close()  # its end


@contextmanager
def bridge(*options, told):
    """`limber ros2`; its lines go to the file `told`. SIGTERM is its good end."""
    with open(told, "w", encoding="utf-8") as file:
        command = [sys.executable, "-u", "-m", "limber", "ros2", *options]
        with started(command, stdout=file, stderr=subprocess.STDOUT) as process:
            yield process
            process.terminate()
            assert process.wait(timeout=LONG_S) == 0, told.read_text(encoding="utf-8")


def vector(message) -> list[float]:
    return [message[axis] for axis in "xyz"]


def base_axes(wrench, pose) -> np.ndarray:
    """The force of a wrench in tip axes, by the pose that came with it."""
    turned = pose["pose"]["orientation"]
    R_BT = matrix_of(np.array([turned[axis] for axis in "wxyz"]))
    return R_BT @ np.array(vector(wrench["wrench"]["force"]))


def values(status) -> dict[str, str]:
    return {pair["key"]: pair["value"] for pair in status["values"]}


def check_what_goes_out(it: Peer, arm, robot) -> None:
    """Each topic against what a script reads; the arm is active and at rest."""
    found = it.next("/joint_states", 10)
    assert found["name"] == list(arm.joint_names)
    np.testing.assert_allclose(found["position"], arm.q, atol=0.01)
    np.testing.assert_allclose(found["effort"], arm.tau, atol=1.0)
    assert len(found["velocity"]) == len(arm.q)
    stamp_s = found["header"]["stamp"]["sec"] + 1e-9 * found["header"]["stamp"]["nanosec"]
    assert abs(time.time() - stamp_s) < LONG_S
    pose = it.next("/limber/tip_pose")
    assert pose["header"]["frame_id"] == robot.base
    np.testing.assert_allclose(vector(pose["pose"]["position"]), arm.pose.p, atol=0.005)
    until(lambda: it.status("arm")["message"].startswith("active"), "ACTIVE in the diagnostics")
    assert values(it.status("arm"))["law"] == arm.law
    for name in arm.joint_names:
        assert float(values(it.status(f"joint {name}"))["temperature_degC"]) > 0
    assert it.newest("/robot_description")["data"] == robot.urdf.read_text(encoding="utf-8")
    assert len(it.heard["/robot_description"]) == 1


def check_contact(it: Peer, arm, robot) -> None:
    """A push in base axes comes back in the tip's; without a source there is no message."""
    assert values(it.status("arm"))["contact_wrench"] == "none"
    assert not it.heard["/limber/contact_wrench"]
    arm.gains(contact="joint_torque")
    arm.push(PUSH_N, for_s=30.0, ramp_s=0.2)
    found = []

    def pushed() -> bool:
        wrench = it.next("/limber/contact_wrench")
        assert wrench["header"]["frame_id"] == robot.tip
        found.append(base_axes(wrench, it.newest("/limber/tip_pose")))
        return bool(np.abs(found[-1] - PUSH_N).max() < 0.5)

    until(pushed, f"{PUSH_N} N")
    source = "joint_torque"
    until(lambda: values(it.status("arm"))["contact_wrench"] == source, source)


def check_commands(it: Peer, arm, told) -> None:
    """A goal and a stiffness arrive; what is wrong is refused with words, and nothing changes."""
    until(lambda: it.subscribers("/limber/goal_pose") == 1, "the bridge")
    goal = it.next("/limber/tip_pose")
    goal["pose"]["position"]["x"] += 0.02
    it.send("/limber/goal_pose", goal)
    wanted = vector(goal["pose"]["position"])
    until(lambda: np.abs(arm.goal.p - wanted).max() < 1e-6, "the goal")
    it.send("/limber/stiffness", [150.0, 160.0, 170.0])
    until(lambda: np.allclose(np.diag(arm.stiffness)[:3], [150, 160, 170], rtol=1e-3), "K_x")
    until(lambda: values(it.status("commands"))["accepted"] == "2", "two accepted")
    turned = {**goal["pose"], "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 0.0}}
    nowhere = {**goal["pose"], "position": {"x": float("nan"), "y": 0.0, "z": 0.0}}
    map_frame = {**goal["header"], "frame_id": "map"}
    wrong = [
        ("/limber/goal_pose", {**goal, "header": map_frame}, "goal_pose: frame_id is 'map'"),
        ("/limber/goal_pose", {**goal, "pose": turned}, "orientation: has length 0"),
        ("/limber/goal_pose", {**goal, "pose": nowhere}, "is not finite"),
        ("/limber/stiffness", [100.0], "stiffness: expected 3 numbers"),
        ("/limber/stiffness", [100.0, float("nan"), 100.0], "is not finite"),
        ("/limber/stiffness", [1e9, 100.0, 100.0], "is out of range"),
    ]
    for number, (topic, message, words) in enumerate(wrong, 1):
        it.send(topic, message)
        until(lambda: values(it.status("commands"))["refused"] == str(number), words)  # noqa: B023
        assert it.status("commands")["level"] == 1 and words in it.status("commands")["message"]
        assert words in told.read_text(encoding="utf-8")
    assert np.abs(arm.goal.p - wanted).max() < 1e-6
    arm.stop()
    until(lambda: it.status("arm")["message"].startswith("hold"), "HOLD")
    it.send("/limber/goal_pose", goal)
    until(lambda: "request.MODE" in it.status("commands")["message"], "a refusal by the mode")
    np.testing.assert_allclose(np.diag(arm.stiffness)[:3], [150, 160, 170], rtol=1e-3)


def wait_for_stack(make):
    """An Arm, once there is a stack."""
    for _ in range(60):
        try:
            return make()
        except NoStackError:
            time.sleep(1.0)
    raise AssertionError("no stack")
