"""Move the tip and the joints, and hear when the arm does not get there."""

import numpy as np

from limber import Arm, NotReachedError

with Arm() as arm:
    arm.activate()
    start = arm.goal

    state = arm.move([0, 0, 0.05])  # returns when the arm rests there
    print("5 cm up; short of it by", np.round(1e3 * np.linalg.norm(state.error[:3]), 1), "mm")

    arm.go_to(position_m=start.p + np.array([0, 0.05, 0]), duration_s=1.0)
    print("at", np.round(arm.pose.p, 3), "m")

    try:
        arm.go_to(start, tolerance_m=1e-6)  # no soft arm is that exact: friction holds it
    except NotReachedError as error:
        print(error)
    print("back, missing", np.round(1e3 * arm.error[:3], 1), "mm")
