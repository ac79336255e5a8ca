"""A gains request changes what it names, in the running processes, whoever sends it."""

import numpy as np

from limber.lcmtypes.controller_status_t import controller_status_t as Status
from test_send import limber_send


def stiffness(stack) -> np.ndarray:
    return np.array(stack.user.latest("CONTROLLER_STATUS").K_x)


def send(stack, *entries: str, client: int | None = None) -> None:
    done = limber_send(*entries, client=client)
    assert done.returncode == 0, done.stderr
    answered = stack.user.count("CONTROLLER_STATUS")
    stack.until(lambda: stack.user.count("CONTROLLER_STATUS") > answered + 40, 5, "the ramp")


def test_each_request_builds_on_what_the_controller_has(stack):
    stack.start_all()
    stack.until(lambda: stack.mode == Status.MODE_IDLE, 20, "IDLE")
    send(stack, "mode: hold")
    stack.until(lambda: stack.state.drive_state == stack.state.DRIVE_ON, 10, "the drives")
    start = stiffness(stack)
    wanted = start.copy()
    wanted[:3, :3] = np.diag([600, 700, 800])
    send(stack, "gains: {K_x_translation_N_per_m: [600, 700, 800]}", "mode: release")
    assert np.allclose(stiffness(stack), wanted)
    send(stack, "gains: {damping_ratio: 0.4}", "mode: release", client=5)
    assert np.allclose(stiffness(stack), wanted), "a damping ratio alone, from another client"
    send(stack, "gains: {reset: true}")
    assert np.allclose(stiffness(stack), start)


def test_the_arm_is_the_running_stacks(stack):
    stack.start_all()
    stack.until(lambda: stack.mode == Status.MODE_IDLE, 20, "IDLE")
    wrong = limber_send("--robot", "planar2r", "mode: hold")
    assert wrong.returncode == 2
    assert "the running stack drives openarm, not planar2r" in wrong.stderr
