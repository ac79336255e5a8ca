"""A node that answers in a drive's place, beside the drive: the arm stops and names the joint."""

import threading
import time

import can
import pytest
from local_drive import multicast_group

from limber.lcmtypes.controller_status_t import controller_status_t as Status
from limber.lcmtypes.joint_state_t import joint_state_t as State

JOINT, REPLY_ID = 2, 19  # joint3 of openarm


def send_again_and_again(node: can.BusABC, reply: can.Message, ended: threading.Event) -> None:
    while not ended.is_set():
        node.send(reply)
        time.sleep(0.0002)


@pytest.mark.realtime
def test_a_node_that_answers_beside_a_drive(stack):
    stack.start_all()
    stack.bring_to(Status.MODE_ACTIVE)
    group = multicast_group("openarm")
    with can.Bus(interface="udp_multicast", channel=group, hop_limit=0, fd=True) as node:
        reply = next(frame for frame in node if frame.arbitration_id == REPLY_ID)
        ended = threading.Event()
        forger = threading.Thread(target=send_again_and_again, args=(node, reply, ended))
        forger.start()
        try:
            stack.until(
                lambda: stack.state.drive_state == State.DRIVE_HOLD, 20, "the drives to hold"
            )
        finally:
            ended.set()
            forger.join()
    assert stack.state.fault == State.FAULT_REPLY_INVALID
    assert stack.state.fault_joint == JOINT
    stack.until(lambda: "(joint3)" in stack.log("driver"), 5, "the joint's name in the log")
