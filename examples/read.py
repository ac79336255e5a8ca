"""Read a running arm: its newest values, now and ten times a second."""

from itertools import islice

import numpy as np

from limber import Arm

np.set_printoptions(precision=3, suppress=True)

with Arm() as arm:  # reading takes no lease and moves nothing
    print(f"{arm.name}: {arm.mode}, law {arm.law}, joints {', '.join(arm.joint_names)}")
    print("position q   ", arm.q, "rad")
    print("torque tau   ", arm.tau, "N m")
    print("tip at       ", arm.pose.p, "m, quaternion w x y z", arm.pose.quat)
    print("stiffness    ", np.diag(arm.stiffness), "N/m and N m/rad")
    print("wrong        ", arm.faults or "nothing")

    for state in islice(arm.states(hz=10), 20):
        print(f"{state.time_s:8.3f} s  tip at {state.pose.p} m, {state.error[:3] * 1e3} mm off")
