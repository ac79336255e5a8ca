"""What an experiment is given: a folder, a lab, the laws, a seeded generator, a picture."""

import zlib
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from rich.console import Console

from limber import runner
from limber.experiments import evaluate, pictures
from limber.experiments.catalog import Experiment
from limber.jobs import load_checked
from limber.logs import Log
from limber.paths import output_folder

PICTURE = "picture.png"


@dataclass(frozen=True)
class Context:
    experiment: Experiment
    out: Path
    rng: np.random.Generator  # the same numbers in every run of the experiment
    console: Console

    def lab(self, scenario: dict[str, Any] | str, name: str = "run") -> Log:
        """Runs a scenario in one process and reads its log.

        A mapping is written to NAME.yaml in the output folder; a string is a file beside
        experiment.py. Scenario, robot and log stay in the folder NAME.
        """
        if isinstance(scenario, str):
            path = self.experiment.folder / scenario
        else:
            path = self.out / f"{name}.yaml"
            content = {"format": "limber-scenario/1", **scenario}
            path.write_text(yaml.safe_dump(content, sort_keys=False), encoding="utf-8")
        self.say(f"lab: {name}")
        folder = output_folder(self.out / name)
        result = runner.lab(load_checked(path), folder, Console(quiet=True))
        return Log(result.log)

    def eval(self, cases: list[dict[str, Any]]) -> list[dict[str, Any]]:
        """Answers of the controller's own classes; questions are made by evaluate.case."""
        return evaluate.evaluate(cases)

    def picture(
        self, title: str, rows: int = 1, columns: int = 1, size: tuple[float, float] = (9.0, 5.2)
    ) -> AbstractContextManager[Any]:
        """Gives the axes to draw in (one, or an array), and saves them when the block ends."""
        return pictures.picture(self.out / PICTURE, title, rows, columns, size)

    def say(self, what: str) -> None:
        """What is being done now, for whoever waits."""
        self.console.print(f"{self.experiment.id}: {what}", highlight=False, soft_wrap=True)


def make_context(experiment: Experiment, folder: Path, console: Console) -> Context:
    seed = zlib.crc32(experiment.id.encode())
    return Context(experiment, folder, np.random.default_rng(seed), console)
