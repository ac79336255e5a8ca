"""Finds the experiments: every folder experiments/Exx_name/ with an experiment.py."""

import importlib
import importlib.util
import itertools
import re
import sys
from collections.abc import Callable
from dataclasses import dataclass
from importlib.machinery import ModuleSpec
from pathlib import Path
from types import ModuleType

from limber.errors import InputError, LimberError
from limber.paths import ROOT
from limber_lecture.comparison import Comparison

FOLDER_NAME = re.compile(r"(E\d\d)_[a-z0-9_]+")
FIELDS = {"TITLE": str, "CLAIM": str, "SECTION": str, "PLANT": str, "FAST": bool}


@dataclass(frozen=True)
class Experiment:
    """The constants and run() of an experiment.py."""

    id: str
    folder: Path
    title: str
    claim: str
    section: str
    plant: str
    fast: bool
    run: Callable[..., list[Comparison]]  # with a Context


def catalog(root: Path | None = None) -> list[Experiment]:
    """All experiments in the order of their numbers."""
    root = root or ROOT / "lecture" / "experiments"
    folders = sorted(path.parent for path in root.glob("E*/experiment.py"))
    found = [load(folder) for folder in folders]
    for before, after in itertools.pairwise(found):
        if before.id == after.id:
            raise InputError(f"{after.folder}: {before.folder.name} has the same number")
    return found


def choose(words: list[str], experiments: list[Experiment]) -> list[Experiment]:
    """`all`, or numbers such as E04, e4 or 4."""
    if words == ["all"]:
        return experiments
    known = {experiment.id: experiment for experiment in experiments}
    chosen = {}
    for word in words:
        number = re.fullmatch(r"[eE]?(\d{1,2})", word)
        key = f"E{int(number[1]):02}" if number else word
        if key not in known:
            raise InputError(f"no experiment '{word}': give all, or some of {', '.join(known)}")
        chosen[key] = known[key]
    return list(chosen.values())


def load(folder: Path) -> Experiment:
    """The experiment of one folder."""
    match = FOLDER_NAME.fullmatch(folder.name)
    if match is None:
        raise InputError(f"{folder}: an experiment's folder is named like E04_finite_deviation")
    try:
        module = _import(folder)
    except LimberError:
        raise
    except Exception as error:
        raise InputError(f"{folder.name}: {type(error).__name__}: {error}") from error
    for name, kind in FIELDS.items():
        if not isinstance(getattr(module, name, None), kind):
            raise InputError(f"{folder.name}/experiment.py: missing {name}, a {kind.__name__}")
    if not callable(getattr(module, "run", None)):
        raise InputError(f"{folder.name}/experiment.py: missing run(context)")
    values = {name.lower(): getattr(module, name) for name in FIELDS}
    return Experiment(id=match[1], folder=folder, run=module.run, **values)


def _import(folder: Path) -> ModuleType:
    """As a package of its own, so that experiment.py can import the files beside it."""
    package = f"limber_{folder.name}_{abs(hash(str(folder.resolve()))):x}"
    if package not in sys.modules:
        spec = ModuleSpec(package, None, is_package=True)
        spec.submodule_search_locations = [str(folder)]
        sys.modules[package] = importlib.util.module_from_spec(spec)
    return importlib.import_module(f"{package}.experiment")
