"""Requests to a running stack: accepted, or refused with a reason."""

import subprocess
import sys

import numpy as np
import pytest

from limber.lcmtypes.controller_status_t import controller_status_t as Status
from limber.live.client import Client, RefusedError
from limber.live.watch import law_names
from stack import BIN, ROOT

# Realtime on a machine that others use: a pause longer than the driver bridges is not our fault.
pytestmark = pytest.mark.flaky(reruns=2)


def limber_send(*entries: str, client: int | None = None) -> subprocess.CompletedProcess:
    """Through the command line; as another client, by the program itself."""
    command = [sys.executable, "-m", "limber", "send"]
    if client is not None:
        command = [str(BIN / "limber-send"), "--client", str(client)]
    return subprocess.run(
        [*command, *entries],
        cwd=ROOT / "tools",
        timeout=30,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture
def standing(stack):
    """Drives that may be switched on."""
    stack.start_all()
    stack.until(lambda: stack.mode == Status.MODE_IDLE, 20, "IDLE")
    return stack


@pytest.fixture
def arm():
    with Client("openarm") as client:
        yield client


def status(stack) -> Status:
    return stack.user.latest("CONTROLLER_STATUS")


def activate(stack, client: Client) -> None:
    client.mode("hold")
    stack.until(lambda: stack.state.drive_state == stack.state.DRIVE_ON, 10, "the drives")
    stack.until(lambda: tries(lambda: client.mode("active")), 10, "ACTIVE")
    stack.until(lambda: stack.mode == Status.MODE_ACTIVE, 10, "ACTIVE")


def tries(request) -> bool:
    try:
        request()
    except RefusedError:
        return False
    return True


def test_client_sends_mode_gains_goal_and_push(standing, arm):
    stack = standing
    activate(stack, arm)

    law = law_names().index("joint_pd")
    assert status(stack).law != law
    arm.gains(law="joint_pd", ramp_s=0.2)
    stack.until(lambda: status(stack).law == law, 5, "the other law")

    arm.gains(law="cartesian_impedance", K_x_translation_N_per_m=800, ramp_s=0.2)
    x, y, z = status(stack).p_BD
    arm.goal(offset_m=[0, 0, 0.03], duration_s=0.5)
    there = [x, y, z + 0.03]
    stack.until(lambda: np.allclose(status(stack).p_BD, there, atol=1e-9), 10, "the goal")

    arm.push(force_N=[0, 6, 0], for_s=5, ramp_s=0.1)
    stack.until(lambda: np.allclose(stack.truth.F_push[:3], [0, 6, 0]), 5, "the push")


def test_refusals_come_with_their_reason(standing, arm):
    with pytest.raises(RefusedError, match="ACTIVE is entered from HOLD, drives on"):
        arm.mode("active")
    with pytest.raises(RefusedError, match="goals are accepted in ACTIVE only"):
        arm.goal(offset_m=[0, 0, 0.01])
    with pytest.raises(RefusedError, match="admittance needs a contact source"):
        arm.gains(law="admittance")
    with pytest.raises(RefusedError, match="K_z_translation"):
        arm.gains(K_z_translation_N_per_m=3)
    arm.gains(damping_ratio=0.8)  # and the client goes on


def test_two_clients_and_the_lease(standing, arm):
    arm.gains(damping_ratio=0.8)
    with Client("openarm", client=5) as other:
        for request in (lambda: other.gains(damping_ratio=0.9), lambda: other.mode("hold")):
            with pytest.raises(RefusedError, match="another client holds the lease"):
                request()
        other.mode("stop")  # needs no lease
        arm.mode("release")
        other.gains(damping_ratio=0.9)
        with pytest.raises(RefusedError, match="another client holds the lease"):
            arm.gains(damping_ratio=0.8)
    arm.gains(damping_ratio=0.8)  # the other one gave it back at its end


def test_command_line(standing):
    stack = standing
    done = limber_send("mode: hold")
    assert done.returncode == 0, done.stderr
    stack.until(lambda: stack.mode == Status.MODE_HOLD, 10, "HOLD")
    wrong = limber_send("gains: {law: salisburry}")
    assert wrong.returncode == 2
    assert "did you mean 'salisbury'?" in wrong.stderr
    unfit = limber_send("gains: {law: admittance}")
    assert unfit.returncode == 2
    assert (
        "refused by the controller: request.LAW: admittance needs a contact source" in unfit.stderr
    )
    stranger = limber_send("mode: idle", client=5)
    assert stranger.returncode == 2
    assert "another client holds the lease" in stranger.stderr
    assert limber_send("mode: release").returncode == 0
    assert limber_send("mode: idle", client=5).returncode == 0
    stack.until(lambda: stack.mode == Status.MODE_IDLE, 10, "IDLE")


def test_nobody_there(tmp_path):
    done = limber_send("mode: hold")
    assert done.returncode == 2
    assert "no controller answers" in done.stderr
