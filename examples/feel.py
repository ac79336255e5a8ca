"""Go down until the arm feels something: here a wall, 3 cm below the simulated hand."""

from limber import Arm

with Arm() as arm:
    arm.activate()
    arm.gains(law="cartesian_impedance", contact="joint_torque")  # or "tip_sensor", with one
    arm.wait(for_s=1.0)  # just enabled, the simulated arm still feels its stand
    start = arm.goal
    arm.wall(arm.pose.p - [0, 0, 0.03], normal=[0, 0, 1])

    arm.set_goal(offset_m=[0, 0, -0.06], duration_s=3.0)  # does not wait
    try:
        # Friction looks like 3 to 6 N here: more than that is contact.
        felt = arm.wait(contact_N=12.0, timeout_s=10.0)
        print(f"contact, {felt.wrench[2]:.1f} N from below at z = {felt.pose.p[2]:.4f} m")
    finally:
        arm.go_to(start, duration_s=1.0)
        arm.no_wall()
    print("and back")
