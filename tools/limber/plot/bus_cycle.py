"""The traffic of one cycle on each bus of an arm, as `limber-check` predicts it."""

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt

from limber.plot.style import COLORS, STYLE

MS = 1e3


def draw(report: dict[str, Any], path: Path) -> None:
    """`report`: what `limber-check robot ROBOT --json` prints."""
    buses = report["buses"]
    rows = sum(len({frame["name"] for frame in bus["cycle"]}) for bus in buses)
    period = MS / report["rate_hz"]
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(
            len(buses), 1, figsize=(9.0, 1.2 * len(buses) + 0.28 * rows), squeeze=False, sharex=True
        )
        for ax, bus in zip(axes[:, 0], buses, strict=True):
            names = list(dict.fromkeys(frame["name"] for frame in bus["cycle"]))
            for reply, label in ((False, "command"), (True, "reply")):
                frames = [frame for frame in bus["cycle"] if frame["reply"] == reply]
                ax.barh(
                    [names.index(frame["name"]) for frame in frames],
                    [MS * (frame["end_s"] - frame["start_s"]) for frame in frames],
                    left=[MS * frame["start_s"] for frame in frames],
                    height=0.7,
                    color=COLORS[reply],
                    label=label,
                    zorder=2,
                )
            ax.axvline(MS * bus["predicted_end_s"], color="0.35", ls="--", label="predicted end")
            ax.axvline(MS * bus["reply_window_s"], color="0.35", label="reply window")
            ax.axvline(period, color="black", lw=2.0, label="next cycle")
            ax.set_yticks(range(len(names)), names)
            ax.invert_yaxis()
            ax.set_xlim(0.0, 1.04 * period)
            load = 100 * bus["predicted_load"]
            ax.set_title(f"{report['name']}, bus {bus['name']}: {load:.0f} % busy", loc="left")
        axes[-1, 0].set_xlabel("time since the start of the cycle, ms")
        axes[0, 0].legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
        figure.savefig(path, dpi=130, bbox_inches="tight")
        plt.close(figure)
