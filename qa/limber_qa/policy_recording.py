"""Writes scenarios/policy.yaml, the stream of `limber demo policy`, from a seed."""

import numpy as np

from limber.output import write_again
from limber.paths import SCENARIOS

RATE_HZ, JITTER_S, TRANSPORT_S, LOSS, SEED = 30, 0.02, 0.01, 0.10, 31
DELAY_S = 1 / RATE_HZ + JITTER_S + TRANSPORT_S
OPEN_M, CLOSED_M, FORCE_N = 0.088, -0.01, 40
START_S, VALID_S = 1.5, 1.0
KILLED_S, AGAIN_S = 5.2, 9.0  # arm time; between them there is no policy
PAUSE_S = (3.6, 3.9)  # it thinks
# Where the arm is held at its home pose
HOME_M = np.array([0.27404, -0.24885, 0.53224])
HOME_QUAT = (0.127255, 0.652939, 0.078190, 0.742538)
# When on the policy's clock, s; where from home, m; the hand's width then
WAY = (
    (0.0, (0.0, 0.0, 0.0), OPEN_M),
    (0.3, (0.0, 0.0, 0.0), CLOSED_M),
    (1.8, (0.0, 0.0, 0.0), CLOSED_M),
    (2.8, (0.0, 0.0, 0.06), CLOSED_M),
    (4.8, (0.0, 0.07, 0.06), CLOSED_M),
    (5.8, (0.0, 0.07, 0.0), CLOSED_M),
    (6.2, (0.0, 0.07, 0.0), OPEN_M),
    (7.2, (0.0, 0.07, 0.0), OPEN_M),
    (8.2, (0.0, 0.07, 0.06), OPEN_M),
)
EARLY_MS, LATE_MS = round(TRANSPORT_S * 1e3), round((TRANSPORT_S + JITTER_S) * 1e3)
THINKS = f"at {PAUSE_S[0]} s the policy thinks for {PAUSE_S[1] - PAUSE_S[0]:.1f} s"
BLOCK = (
    "name: block, position_m: [0.452, -0.258, 0.557], width_m: 0.05, stiffness_N_per_m: 100000, "
    "damping_Ns_per_m: 50, mass_kg: 0.4, friction: 0.6"
)
HEAD = f"""# A policy at {RATE_HZ} Hz takes a block, carries it and puts it down. Written by
# limber_qa/policy_recording.py. Each target comes {EARLY_MS} to {LATE_MS} ms late, {LOSS:.0%} do
# not come; {THINKS};
# at {KILLED_S} s it is killed, and started again at {AGAIN_S} s.
format: limber-scenario/1
name: policy
description: a policy picks and places with pauses, jitter, loss, and an end in the middle
robot: openarm_right
mode: realtime
duration_s: 15

objects:
  - {{{BLOCK}}}

timeline:
  - {{at_s: 0.3, mode: hold}}
  - {{at_s: 0.8, mode: active}}
  - {{at_s: {AGAIN_S - 0.3}, mode: active}}
"""


def target(t: float) -> tuple[np.ndarray, float]:
    """Position, m, and width at `t` on the policy's clock: minimum jerk between the points."""
    times = [at for at, _, _ in WAY]
    i = min(int(np.searchsorted(times, t, side="right")), len(WAY) - 1)
    (t0, p0, width), (t1, p1, _) = WAY[i - 1], WAY[i]
    s = float(np.clip((t - t0) / (t1 - t0), 0.0, 1.0))
    way = s**3 * (10 - 15 * s + 6 * s**2)
    return HOME_M + np.array(p0) + way * (np.array(p1) - np.array(p0)), width


def recording() -> str:
    rng, entries = np.random.default_rng(SEED), []
    gone_s = AGAIN_S - KILLED_S
    for k in range(int(WAY[-1][0] * RATE_HZ) + RATE_HZ):
        clock_s = k / RATE_HZ
        stamp_s = START_S + clock_s
        stamp_s += gone_s if stamp_s >= KILLED_S else 0.0
        arrival_s = stamp_s + TRANSPORT_S + JITTER_S * rng.uniform()
        if rng.uniform() < LOSS or PAUSE_S[0] <= stamp_s < PAUSE_S[1]:
            continue
        p, width = target(clock_s)
        entries.append(
            f"  - {{at_s: {arrival_s:.4f}, stream: {{t0_s: {stamp_s:.4f}, dt_s: [0], "
            f"delay_s: {DELAY_S:.3f}, valid_for_s: {VALID_S}, "
            f"position_m: [[{p[0]:.5f}, {p[1]:.5f}, {p[2]:.5f}]], "
            f"quaternion_wxyz: [[{', '.join(f'{x:.6f}' for x in HOME_QUAT)}]], "
            f"hand_width_m: {width}, hand_force_N: {FORCE_N}}}}}\n"
        )
    return HEAD + "".join(entries)


if __name__ == "__main__":
    write_again(SCENARIOS / "policy.yaml", recording())
