"""Episodes of a log over each other, each from its own start: joints, and the hand's width."""

from collections.abc import Sequence
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from rich.console import Console

from limber.errors import InputError
from limber.log import episodes
from limber.log.episodes import Episode
from limber.log.reader import Log
from limber.log.results import written_whole
from limber.messages import joint_name
from limber.paths import output_folder
from limber.plot.style import COLORS, STYLE

POINTS = 1500  # of an episode, more are not seen
WIDTH_INCH, ROW_INCH = 9.0, 1.6


def draw(
    path: Path, numbers: Sequence[int], out: Path, joints: Sequence[str], console: Console
) -> None:
    if out.suffix != ".png":
        raise InputError(f"--plot {out}: end it in .png")
    log = Log(path)
    chosen = episodes.chosen(episodes.episodes(log), numbers)
    if not chosen:
        raise InputError(f"{log.path}: no episode to draw")
    told = next(log.each("ROBOT_INFO"), None)
    names = list(told.joints) if told else joints
    rows = _rows(log, names)
    output_folder(out.parent)
    with plt.rc_context(STYLE):
        size = WIDTH_INCH, ROW_INCH * len(rows) + 0.8
        figure, axes = plt.subplots(len(rows), 1, sharex=True, figsize=size, squeeze=False)
        for ax, (title, stamps_us, values) in zip(axes[:, 0], rows, strict=True):
            _lines(ax, chosen, stamps_us, values)
            ax.set_ylabel(title, parse_math=False)
        axes[-1, 0].set_xlabel("time since the episode's start (s)")
        axes[0, 0].legend(fontsize=8, loc="center left", bbox_to_anchor=(1.0, 0.5))
        with written_whole(out) as part:
            figure.savefig(part, dpi=130, format="png", bbox_inches="tight")
        plt.close(figure)
    console.print(f"wrote {out}", soft_wrap=True)


def _rows(log: Log, names: Sequence[str]) -> list[tuple[str, np.ndarray, np.ndarray]]:
    """Title, time stamps and values of each."""
    count = len(log.channels.get("JOINT_STATE", ()))
    stamps_us, state = log.records("JOINT_STATE", 0, count)
    if not len(state):
        raise InputError(f"{log.path} holds no JOINT_STATE")
    joints = range(int(state["num_joints"][0]))
    rows = [(f"{joint_name(names, i)} (rad)", stamps_us, state["q"][:, i]) for i in joints]
    if "HAND_STATE" in log.channels:
        stamps_us, hand = log.records("HAND_STATE", 0, len(log.channels["HAND_STATE"]))
        rows.append(("hand (mm)", stamps_us, 1e3 * hand["width_m"]))
    return rows


def _lines(ax: Axes, chosen: list[Episode], stamps_us: np.ndarray, values: np.ndarray) -> None:
    for i, episode in enumerate(chosen):
        begin, end = np.searchsorted(stamps_us, [episode.start_us, episode.end_us])
        rows = slice(begin, end, max((end - begin) // POINTS, 1))
        t_s = (stamps_us[rows] - episode.start_us) * 1e-6
        name = f"{episode.number} {episode.outcome or 'no end'}"
        ax.plot(t_s, values[rows], label=name, color=COLORS[i % len(COLORS)], alpha=0.8)
