"""desktop2r for real time on a machine that others use: two cycles bridge a pause of 80 ms.

Slower than 25 Hz is no better, since the controller gives up 100 ms after the last state.
"""

from pathlib import Path

import yaml

from stack import ROOT

DESKTOP2R = ROOT / "robots" / "desktop2r"
RATE_Hz = 25


def slow_arm(folder: Path, **changed: object) -> Path:
    """Writes the arm's folder. It lies flat, and its springs are as soft as that rate needs."""
    robot = yaml.safe_load((DESKTOP2R / "robot.yaml").read_text(encoding="utf-8"))
    robot |= {"rate_hz": RATE_Hz, "gravity_m_per_s2": [0, 0, -9.81], **changed}
    robot["watchdog"]["timeout_s"] = 0.3
    robot["gains"] |= {"K_q_Nm_per_rad": [4, 1], "K_x_translation_N_per_m": 15}
    folder.mkdir()
    (folder / "robot.urdf").write_text((DESKTOP2R / "robot.urdf").read_text(encoding="utf-8"))
    (folder / "robot.yaml").write_text(yaml.safe_dump(robot), encoding="utf-8")
    return folder
