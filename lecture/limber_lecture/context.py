"""What an experiment gets: a folder, a lab, the laws, a seeded generator, a picture."""

import os
import zlib
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from rich.console import Console

from limber.log.reader import Log
from limber.model.scenario import active_with
from limber.paths import output_folder
from limber.run import runner
from limber.run.commands import load_scenario
from limber.run.options import LOG_NAME
from limber_lecture import evaluate, pictures
from limber_lecture.catalog import Experiment
from limber_lecture.comparison import Comparison, at_least, at_most, ideal_and_bus, near_zero
from limber_lecture.evaluate import case
from limber_qa.check_trace.judge import require_no_breach

# What every experiment needs is imported from here
__all__ = ["Comparison", "Context", "at_least", "at_most", "case", "ideal_and_bus", "near_zero"]

PICTURE = "picture.png"
# No springs, friction or drives: nothing happens between two commands that Runge-Kutta steps of a
# period would miss.
SMOOTH, PERIOD_S = ("ideal7", "planar2r"), 1e-3
CHECK_TRACE = "LIMBER_CHECK_TRACE"  # 1: the frames of every run are judged


@dataclass(frozen=True)
class Context:
    experiment: Experiment
    out: Path
    rng: np.random.Generator  # the same numbers in every run of the experiment
    console: Console

    def lab(self, scenario: dict[str, Any] | str, name: str = "run") -> Log:
        """Runs a scenario in one process and reads its log.

        A mapping is written to NAME.yaml in the output folder; a string is a file beside
        experiment.py. Scenario, robot and log stay in the folder NAME. Frames take no time unless
        the scenario has `wire: true`.
        """
        if isinstance(scenario, str):
            path = self.experiment.folder / scenario
        else:
            path = self.out / f"{name}.yaml"
            # Formulas know no bus, and experiments show what unstable gains do.
            head = {"format": "limber-scenario/1", "wire": False, "allow_unstable": True}
            content = evaluate.plain({**head, **scenario})
            path.write_text(yaml.safe_dump(content, sort_keys=False), encoding="utf-8")
        self.progress(f"lab: {name}")
        folder = output_folder(self.out / name)
        (folder / LOG_NAME).unlink(missing_ok=True)  # of the last time
        judged = os.environ.get(CHECK_TRACE) == "1"
        result = runner.lab(load_scenario(path), folder, Console(quiet=True), record_can=judged)
        if judged:
            require_no_breach(result.can_log, str(folder))
            result.can_log.unlink()
        return Log(result.log)

    def run_law(
        self,
        name: str,
        robot: str,
        gains: dict[str, Any],
        entries: list[dict[str, Any]],
        end_s: float,
        **head: Any,
    ) -> Log:
        """Runs a law on exact equations: the arm is held, becomes active, and gets `gains` at 1 s.

        `entries` of the timeline follow, until `end_s`; `head`: what else is in the scenario.
        """
        scenario = {"robot": robot, "integrator": "reference", "duration_s": end_s + 0.1, **head}
        if robot in SMOOTH and scenario["integrator"] == "reference":
            scenario.setdefault("step_s", PERIOD_S)
        return self.lab({**scenario, "timeline": [*active_with(gains), *entries]}, name)

    def eval(self, cases: list[dict[str, Any]]) -> list[dict[str, Any]]:
        """Results of the controller's own classes; `case` makes one."""
        return evaluate.evaluate(cases)

    def picture(
        self, title: str, rows: int = 1, columns: int = 1, size: tuple[float, float] = (9.0, 5.2)
    ) -> AbstractContextManager[Any]:
        """Gives the axes to draw in (one, or an array), and saves them when the block ends."""
        return pictures.picture(self.out / PICTURE, title, rows, columns, size)

    def progress(self, what: str) -> None:
        """Prints what is being done now."""
        self.console.print(f"{self.experiment.id}: {what}", soft_wrap=True)


def make_context(experiment: Experiment, folder: Path, console: Console) -> Context:
    seed = zlib.crc32(experiment.id.encode())
    return Context(experiment, folder, np.random.default_rng(seed), console)
