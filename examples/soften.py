"""How far does 8 N push the hand of the simulated arm, for one stiffness after the other?"""

from limber import Arm

FORCE_N = 8.0

with Arm() as arm:
    arm.activate()
    arm.gains(law="cartesian_impedance", damping_ratio=0.9)
    for stiffness in (200, 400, 800):  # N/m; what is not named stays as it is
        arm.soften(stiffness)
        before = arm.wait(at_rest=True)
        arm.push([0, FORCE_N, 0], for_s=1.5, ramp_s=0.2)
        pushed = arm.wait(for_s=1.2)
        moved_mm = 1e3 * (pushed.pose.p[1] - before.pose.p[1])
        print(
            f"{pushed.stiffness[1, 1]:4.0f} N/m: {moved_mm:5.1f} mm; "
            f"force / stiffness {1e3 * FORCE_N / stiffness:5.1f} mm"
        )
        arm.wait(for_s=0.5)  # the push is over
