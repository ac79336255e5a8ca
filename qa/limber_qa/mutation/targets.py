"""What is mutated, and by which programs: tests/mutation/targets.yaml."""

from dataclasses import dataclass
from pathlib import Path

import yaml

from limber.errors import InputError
from limber.paths import ROOT

PATH = ROOT / "tests" / "mutation" / "targets.yaml"


@dataclass(frozen=True)
class Area:
    """Files, relative to the repository, and the tests that are to find their mutants."""

    name: str
    files: tuple[str, ...]
    programs: tuple[str, ...]
    without: tuple[str, ...] = ()  # tests that take too long, as GoogleTest's patterns


def areas(path: Path = PATH) -> list[Area]:
    """All areas in their order; a pattern that fits no file is an error."""
    found, taken = [], set()
    for name, content in yaml.safe_load(path.read_text(encoding="utf-8")).items():
        files: list[str] = []
        for pattern in content["files"]:
            matches = sorted(file for file in ROOT.glob(pattern) if file.suffix in (".h", ".cc"))
            if not matches:
                raise InputError(f"{path.name}: {name}: no source fits '{pattern}'")
            files += [str(file.relative_to(ROOT)) for file in matches]
        files = [file for file in dict.fromkeys(files) if file not in taken]
        taken.update(files)
        without = tuple(content.get("without", ()))
        found.append(Area(name, tuple(files), tuple(content["programs"]), without))
    return found


def chosen(names: list[str], all_areas: list[Area]) -> set[str]:
    """The files that areas or paths name; all if there are none."""
    known = {file for area in all_areas for file in area.files}
    files: set[str] = set()
    for name in names:
        of_area = {file for area in all_areas if area.name == name for file in area.files}
        fitting = of_area or {file for file in known if file == name or Path(file).name == name}
        if not fitting:
            words = ", ".join(area.name for area in all_areas)
            raise InputError(f"'{name}' is not mutated: give one of {words}, or one of their files")
        files |= fitting
    return files or known
