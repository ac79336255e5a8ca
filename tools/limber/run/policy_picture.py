"""`limber demo policy` in one picture: way, hand, torque, and when the policy was not there."""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from limber.model.scenario import Scenario
from limber.plot.style import COLORS, STYLE, name_axes
from limber.run.policy_demo import Found

BLUE, ORANGE, GREEN = COLORS[:3]


def save(found: Found, scenario: Scenario, path: Path) -> None:
    with plt.rc_context(STYLE):
        fig, axes = plt.subplots(4, 1, figsize=(12, 11), sharex=True, layout="constrained")
        for i, (axis, ax) in enumerate(zip("yz", axes[:2], strict=True), start=1):
            zero = found.goal[found.active][0, i]
            ax.plot(found.t, (found.goal[:, i] - zero) * 1e3, color=BLUE, label="goal")
            ax.plot(found.t, (found.tip[:, i] - zero) * 1e3, color=ORANGE, lw=1, label="tip")
            block = (found.block[:, i] - found.block[0, i]) * 1e3
            ax.plot(found.truth_t, block, color=GREEN, lw=1, ls="--", label="block")
            name_axes(ax, "", f"{axis} from home (mm)")
        axes[0].legend(loc="upper left", ncols=3)
        axes[2].plot(found.hand_t, found.hand["width_m"] * 1e3, color=BLUE, label="width (mm)")
        axes[2].plot(found.hand_t, found.hand["force_N"], color=ORANGE, label="force (N)")
        axes[2].legend(loc="upper left", ncols=2)
        name_axes(axes[2], "", "hand")
        n = int(found.status["num_joints"][0])
        axes[3].plot(found.t, found.status["tau_sent"][:, :n], lw=1)
        name_axes(axes[3], "arm time (s)", "joint torque sent (N m)")
        for ax in axes:
            ax.plot(found.sent_s, np.full_like(found.sent_s, ax.get_ylim()[0]), "|", color="gray")
            ax.axvspan(found.killed_s, found.again_s, color="gray", alpha=0.15, lw=0)
            held = found.t[~found.active & (found.t > found.killed_s)]
            if len(held):
                ax.axvspan(held[0], held[-1], color="gray", alpha=0.2, lw=0)
        title = "a policy at 30 Hz; marks: its targets, gray: it is gone, darker: the arm is held"
        fig.suptitle(f"{scenario.robot.name}: {title}", fontsize=13)
        fig.savefig(path, dpi=120)
    plt.close(fig)
