"""LeRobot's own OpenArm on the simulated drives of `limber sim openarm_right`.

With LeRobot's Python: pip install 'lerobot[damiao]' msgpack
"""

import os
import sys
import time

os.environ.setdefault("CAN_CONFIG", '{"hop_limit": 0}')  # python-can's frames stay on this machine

from lerobot.robots.openarm_follower import OpenArmFollower, OpenArmFollowerConfig

GROUP = sys.argv[1] if len(sys.argv) > 1 else "239.74.214.64"  # `limber sim` prints it

robot = OpenArmFollower(
    OpenArmFollowerConfig(port=GROUP, can_interface="udp_multicast", side="right")
)
robot.connect(calibrate=False)  # the simulated drives have their zeros
start = robot.get_observation()
action = dict(start)
for step in range(1, 91):
    action["joint_4.pos"] = start["joint_4.pos"] + step / 6  # degrees
    action["gripper.pos"] = start["gripper.pos"] + step / 4
    robot.send_action(action)
    time.sleep(1 / 30)
    now = robot.get_observation()
for key in ("joint_4.pos", "gripper.pos"):
    print(f"{key}: from {start[key]:.1f} to {now[key]:.1f} degrees")
robot.disconnect()
