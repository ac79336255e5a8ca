"""Are the CAN interfaces there, up, and at the bit rates of robot.yaml?"""

from limber.doctor import can_interfaces
from limber.first_hour.record import PASSED, Found, failed
from limber.model.robot import Robot


def check(robot: Robot) -> Found:
    lines, cures = [], []
    for bus, needs in can_interfaces.needs_of(str(robot.folder)).items():
        if needs.address.startswith("virtual:"):
            lines.append(f"{bus}: {needs.address}, simulated")
            continue
        wrong = can_interfaces.problems(needs)
        lines.append(f"{bus}: {needs.address}: {'; '.join(wrong) or 'as robot.yaml has it'}")
        if wrong:
            cures.append(needs.cure())
    return failed(lines[0], "; ".join(cures), *lines[1:]) if cures else Found(PASSED, tuple(lines))
