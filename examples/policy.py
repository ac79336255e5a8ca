"""Feed the arm from a policy: 30 targets a second, each from what the arm measures."""

import numpy as np

from limber import Arm

RATE_HZ = 30
CENTRE_STEP_M = np.array([-0.04, 0.0, 0.0])


def policy(observation: dict[str, np.ndarray]) -> np.ndarray:
    """Stands for a network: the tip's next position, m. This one draws a circle of 4 cm."""
    t = observation["time_s"]
    return observation["start"] + CENTRE_STEP_M + 0.04 * np.array([np.cos(t), np.sin(t), 0.0])


with Arm() as arm:
    arm.activate()
    arm.gains(law="cartesian_impedance", K_x_translation_N_per_m=800)
    start = arm.goal
    stream = arm.stream(RATE_HZ)
    first = arm.state
    worst_mm = 0.0
    for state in arm.states(hz=RATE_HZ):
        t = state.time_s - first.time_s
        if t > 2 * np.pi:
            break
        observation = {"q": state.q, "v": state.v, "start": start.p, "time_s": t}
        stream.send(position_m=policy(observation), quaternion_wxyz=start.quat)
        worst_mm = max(worst_mm, 1e3 * float(np.linalg.norm(state.error[:3])))
    print(f"a circle in {t:.1f} s; the arm was at most {worst_mm:.1f} mm from its goal")
    print(f"of its targets {arm.state.targets}")
    arm.wait(at_rest=True)
