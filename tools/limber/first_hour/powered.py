"""The runs with drives on, with little torque: held, then soft."""

import json
from pathlib import Path

import numpy as np
from rich.console import Console

from limber.arrays import Floats
from limber.first_hour.bounded import spare_torque, write_bounded
from limber.first_hour.record import PASSED, Found, failed
from limber.log.reader import Log
from limber.model.robot import Robot
from limber.model.scenario import load_scenario
from limber.output import write_new
from limber.paths import output_folder
from limber.run import buses, runner
from limber.run.commands import next_folder, summarize
from limber.run.options import RunOptions

HOLD_S, JUDGED_S = 6.0, 2.0
SOFT_S, SOFT_FROM_S = 20.0, 5.0
SOFT_N_per_m, SOFT_Nm_per_rad = 200.0, 10.0
PUSH_m = 0.04  # of a simulated hand
SEEN_m = 0.005  # a push that counts
BACK = 0.5  # of it, at most, that friction keeps
MODEL_SHARE = 0.25  # of a joint's weight, and ...
FRICTION_SHARE = 0.05  # ... of its torque limit, as the controller's load watch


def hold(robot: Robot, folder: Path, console: Console) -> Found:
    """HOLD, and the torque that carries the arm beside that of the model."""
    console.print(f"Once it holds, let it carry itself: the last {JUDGED_S:.0f} s count.")
    found = _run(robot, folder, "hold", HOLD_S, [], console)
    if isinstance(found, Found):
        return found
    state = found.read("JOINT_STATE")
    n = len(robot.joints)
    last = state[-round(JUDGED_S / (state["period_ns"][0] * 1e-9)) :]
    q, tau = (last[name][:, :n].mean(axis=0) for name in ("q", "tau_applied"))
    return judge_gravity(robot, q, tau)


def judge_gravity(robot: Robot, q: Floats, tau: Floats) -> Found:
    """`tau`: of the motors at rest, N m."""
    lines, wrong = [], []
    gravity = robot.dynamics.gravity_torque(q[None])[0]
    for joint, g, t in zip(robot.joints, gravity, tau, strict=True):
        friction = max(joint.friction + joint.link_friction, FRICTION_SHARE * joint.torque)
        tolerance = friction + MODEL_SHARE * abs(g)
        lines.append(f"{joint.name:16} model {g:+8.2f} N m   motor {t:+8.2f} N m")
        if abs(g) > 2 * friction:
            lines[-1] += f"   {t / g:.2f} of it"
        if not abs(t - g) <= tolerance:
            wrong.append(joint.name)
    if wrong:
        cure = (
            "was it supported? Else, a factor of 2 to 4 in one joint: torque range or model of its "
            "motor in robot.yaml; "
            "another figure in several: masses of the URDF, gravity_m_per_s2, a payload, zeros"
        )
        return failed(f"carries another weight than the model's: {', '.join(wrong)}", cure, *lines)
    return Found(PASSED, tuple(lines))


def push(robot: Robot, folder: Path, console: Console) -> Found:
    """Soft for some seconds: the person, or the simulator, pushes the tip."""
    gains = robot.resolved["gains"]
    law = {
        "law": "cartesian_impedance",
        "K_x_translation_N_per_m": min(SOFT_N_per_m, gains["K_x_translation_N_per_m"]),
        "K_x_rotation_Nm_per_rad": min(SOFT_Nm_per_rad, gains["K_x_rotation_Nm_per_rad"]),
        "spring_force_N": 20,
        "spring_moment_Nm": 4,
        "ramp_s": 1,
    }
    events: list[dict] = [{"at_s": 2.0, "gains": law}, {"at_s": 3.5, "mode": "active"}]
    if not buses.real(robot.buses):
        force = [round(float(x), 3) for x in simulated_push(robot)]
        events.append({"at_s": 8.0, "push": {"force_N": force, "ramp_s": 0.5, "for_s": 4}})
    else:
        console.print(f"From {SOFT_FROM_S:.0f} s on: push the tip by a few centimetres, let go.")
    events.append({"at_s": SOFT_S - 0.5, "mode": "hold"})
    found = _run(robot, folder, "push", SOFT_S, events, console)
    return found if isinstance(found, Found) else judge_push(found)


def judge_push(log: Log) -> Found:
    status = log.read("CONTROLLER_STATUS")
    time_s = (status["time_ns"] - status["time_ns"][0]) * 1e-9
    soft = status[(time_s > SOFT_FROM_S) & (time_s < SOFT_S - 1.0)]
    away_m = np.linalg.norm(soft["e"][:, :3], axis=1)
    far_m, left_m = float(away_m.max()), float(away_m[-len(away_m) // 10 :].mean())
    line = f"the tip was pushed by {1e3 * far_m:.0f} mm and came back to {1e3 * left_m:.0f} mm"
    if not far_m >= SEEN_m:
        return failed(line, f"push the tip between {SOFT_FROM_S:.0f} s and {SOFT_S - 5:.0f} s")
    if not left_m <= BACK * far_m:
        return failed(line, "it was still held, or friction keeps it: docs/first_motion.md, Tuning")
    return Found(PASSED, (line,))


def simulated_push(robot: Robot) -> Floats:
    """N, base axes: where the joints move the tip most, by PUSH_m beyond their friction, with their
    spare torque at most.
    """
    J = robot.chain.jacobian(robot.home)[:3]
    direction: Floats = np.linalg.svd(J)[0][:, 0]
    arms_m = np.maximum(np.abs(J.T @ direction), 1e-6)
    friction = np.array([joint.friction + joint.link_friction for joint in robot.joints])
    wanted = SOFT_N_per_m * PUSH_m + float(np.min(friction / arms_m))
    return min(wanted, float(np.min(spare_torque(robot) / arms_m))) * direction


def _run(
    robot: Robot,
    folder: Path,
    name: str,
    duration_s: float,
    events: list[dict],
    console: Console,
) -> Log | Found:
    """The log; or what failed."""
    place = output_folder(next_folder(name, folder))
    scenario = {
        "format": "limber-scenario/1",
        "name": f"{robot.name} {name}",
        "description": f"limber first-hour: {name}, with little torque",
        "robot": str(write_bounded(robot, place / "bounded").resolve()),
        "mode": "realtime",
        "duration_s": duration_s,
        "seed": 1,
        "timeline": [{"at_s": 0.3, "mode": "hold"}, *events],
    }
    asked = place / f"{name}.yaml"
    write_new(asked, json.dumps(scenario, indent=2) + "\n")
    loaded = load_scenario(asked)
    simulated = not buses.real(robot.buses)
    buses.warn_of_motion(robot.buses, simulated, console)
    options = RunOptions(with_simulator=simulated)
    finished = runner.run(loaded, output_folder(place / "run"), options, console)
    summary, _ = summarize(finished, loaded)
    if finished.stopped_early:
        return failed("stopped by you", "")
    if summary.faults:
        lines = [line for fault in summary.faults for line in fault.lines()]
        return failed(lines[0], f"see above and docs/troubleshooting.md; log: {place}", *lines[1:])
    return Log(finished.log)
