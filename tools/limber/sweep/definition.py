"""What a sweep is: all that decides its numbers, kept in its folder as sweep.json and the files of
a run in scenario/.
"""

import copy
import json
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from hashlib import sha256
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import yaml

from limber import __version__
from limber.errors import InputError
from limber.model.scenario import load_scenario
from limber.output import new_file, write_new
from limber.paths import existing_file
from limber.sweep.keys import put
from limber.sweep.sample import METHODS, seed_of, shares
from limber.sweep.variation import Variation, parse
from limber.yaml_file import read_yaml

FILE, FORMAT = "sweep.json", "limber-sweep/1"
SCENARIO, SOURCES = "scenario.yaml", "scenario"
WHOLE = "expected a whole number"  # the scenario reader's words

Files = dict[str, bytes]  # by their places in the folder of a run


def versions() -> dict[str, str]:
    return {"limber": __version__, "numpy": np.__version__}


def write_files(files: Files, folder: Path) -> Path:
    """Returns the scenario's."""
    for name, data in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        with new_file(folder / name, "wb") as file:
            file.write(data)
    return folder / SCENARIO


@dataclass(frozen=True)
class Sweep:
    """`files`: a scenario, and beside it the robot and the law that it names. `overshoot`: the most
    of a run that holds.
    """

    files: Files
    vary: tuple[Variation, ...]
    method: str
    runs: int
    seed: int
    overshoot: float
    versions: dict[str, str]

    def each(self, left_out: set[int]) -> Iterator[tuple[int, dict[str, Any]]]:
        """Number of each run, and its values by their keys; one of them is the scenario's seed."""
        table = shares(self.method, self.vary, self.runs, self.seed)
        for run in (run for run in range(self.runs) if run not in left_out):
            values = {v.key: v.at(float(s)) for v, s in zip(self.vary, table[run], strict=True)}
            yield run, {"seed": seed_of(self.seed, run), **values}

    def files_of(self, values: dict[str, Any]) -> Files:
        """The scenario with these values, as a person would write it, and what it needs."""
        content, joints = copy.deepcopy(self._read)
        for key, value in values.items():
            put(content, key, value, joints)
        return {**self.files, SCENARIO: _yaml(content)}

    @cached_property
    def _read(self) -> tuple[dict[str, Any], dict[str, Any]]:
        """The scenario, and the joints of robot.yaml."""
        content = yaml.safe_load(self.files[SCENARIO])
        return content, yaml.safe_load(self.files[f"{content['robot']}/robot.yaml"])["joints"]

    def as_json(self) -> dict[str, Any]:
        return {
            "format": FORMAT,
            "files": {name: sha256(self.files[name]).hexdigest() for name in sorted(self.files)},
            "vary": [variation.text for variation in self.vary],
            **{name: getattr(self, name) for name in ("method", "runs", "seed", "overshoot")},
            "versions": self.versions,
        }

    def save(self, folder: Path) -> None:
        write_files(self.files, folder / SOURCES)
        write_new(folder / FILE, json.dumps(self.as_json(), indent=2) + "\n")

    def refuse_another(self, folder: Path) -> None:
        """Raises InputError that names what differs from the sweep in the folder."""
        kept = _kept(folder)
        for name, now in self.as_json().items():
            then = kept.get(name)
            if isinstance(now, dict) and isinstance(then, dict):
                differ = sorted(key for key in now | then if now.get(key) != then.get(key))
                now, then = ({key: of.get(key) for key in differ} for of in (now, then))
            if now != then:
                why = f"{name}: {then} there, {now} here; give another --out"
                raise InputError(f"{folder} is another sweep: {why}")


def load(folder: Path) -> Sweep:
    """As it would begin now with what the folder holds. Raises InputError if that is another one
    than it was.
    """
    kept = _kept(folder)
    files = {name: folder / SOURCES / name for name in kept["files"]}
    sweep = Sweep(
        {name: existing_file(file, "file").read_bytes() for name, file in files.items()},
        tuple(parse(text) for text in kept["vary"]),
        versions=versions(),
        **{name: kept[name] for name in ("method", "runs", "seed", "overshoot")},
    )
    sweep.refuse_another(folder)
    return sweep


def define(
    path: Path, vary: list[str], method: str, runs: int, seed: int, overshoot: float
) -> Sweep:
    """Raises InputError with what the scenario's reader has against it."""
    if method not in METHODS:
        raise InputError(f"--method {method}: there are {', '.join(METHODS)}")
    variations = tuple(parse(text) for text in vary)
    keys = [variation.key for variation in variations]
    if not keys or len(set(keys)) < len(keys):
        raise InputError("--vary: expected once a key, such as --vary gains.K_x=100..2000")
    sweep = Sweep(_sources(path), variations, method, runs, seed, overshoot, versions())
    sweep = replace(sweep, vary=tuple(_checked(sweep, variation) for variation in variations))
    return replace(sweep, runs=len(shares(method, sweep.vary, runs, seed)))


def _sources(path: Path) -> Files:
    scenario = load_scenario(path)
    content, robot = read_yaml(scenario.path), scenario.robot.folder
    content |= {"robot": robot.name, "name": scenario.name}
    files = [robot / "robot.yaml", *robot.glob("*.urdf"), *robot.glob("*.xacro")]
    found = {f"{robot.name}/{file.name}": file.read_bytes() for file in files}
    if "law_file" in content:
        law = scenario.path.parent / content["law_file"]
        content["law_file"] = law.name
        found[law.name] = law.read_bytes()
    return {SCENARIO: _yaml(content), **found}


def _checked(sweep: Sweep, variation: Variation) -> Variation:
    """Its ends are allowed, one at a time; in whole numbers if the scenario takes no others."""
    for end in variation.values or (variation.low, variation.high):
        problem = _complaint(sweep, variation.key, end)
        if WHOLE in problem and not variation.values and end.is_integer():
            text = f"{variation.text.removesuffix(':whole')}:whole"
            variation = replace(variation, text=text, how="whole")
            problem = _complaint(sweep, variation.key, int(end))
        if problem:
            raise InputError(f"--vary {variation.text}: {problem}")
    return variation


def _complaint(sweep: Sweep, key: str, value: Any) -> str:
    """Of the scenario's reader, without the file that it reads here."""
    with TemporaryDirectory(prefix="limber-sweep-") as folder:
        try:
            load_scenario(write_files(sweep.files_of({key: value}), Path(folder)))
        except InputError as error:
            place = rf"{re.escape(folder)}/{SCENARIO}(:\d+)?: "
            return re.sub(place, "", str(error)).splitlines()[0]
    return ""


def _yaml(content: dict[str, Any]) -> bytes:
    return yaml.safe_dump(content, sort_keys=False, allow_unicode=True).encode()


def _kept(folder: Path) -> dict[str, Any]:
    return read_yaml(
        existing_file(folder / FILE, "sweep's folder, with sweep.json")
    )  # JSON is YAML
