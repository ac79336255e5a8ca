"""What has been found so far: kept between calls as JSON, and as a text to attach to a question."""

import hashlib
import json
import platform
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from limber import __version__
from limber.errors import InputError
from limber.model.robot import Robot
from limber.output import write_again

FORMAT = "limber-first-hour/1"
PASSED, FAILED, SKIPPED = "passed", "failed", "skipped"


@dataclass(frozen=True)
class Found:
    """Of one step. `lines`: what was found; `cure`: what to do about it, if it failed."""

    verdict: str
    lines: tuple[str, ...] = ()
    cure: str = ""
    when: str = ""


def failed(line: str, cure: str, *more: str) -> Found:
    return Found(FAILED, (line, *more), cure)


class Record:
    """Of one arm as it is described now: another robot.yaml or URDF begins anew."""

    def __init__(self, robot: Robot, folder: Path) -> None:
        self.folder = folder
        self.found: dict[str, Found] = {}
        self.renewed = False  # an earlier record was of another description
        self._robot = robot
        self._digest = _digest(robot)
        self._load()

    def note(self, step: str, found: Found) -> None:
        """Writes both files."""
        now = time.strftime("%Y-%m-%d %H:%M:%S %z")
        self.found[step] = Found(found.verdict, found.lines, found.cure, now)
        steps = {name: asdict(one) for name, one in self.found.items()}
        content = {"format": FORMAT, "description": self._digest, "steps": steps}
        write_again(self._path, json.dumps(content, indent=2) + "\n")
        write_again(self.text_path, self._text())

    @property
    def text_path(self) -> Path:
        return self.folder / "first_hour.md"

    @property
    def _path(self) -> Path:
        return self.folder / "first_hour.json"

    def _load(self) -> None:
        if not self._path.exists():
            return
        try:
            content: dict[str, Any] = json.loads(self._path.read_text(encoding="utf-8"))
            if content["format"] != FORMAT:
                raise ValueError(content["format"])
            steps = {
                name: Found(one["verdict"], tuple(one["lines"]), one["cure"], one["when"])
                for name, one in content["steps"].items()
            }
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise InputError(f"{self._path} is no record of this version: remove it") from error
        self.renewed = content.get("description") != self._digest
        self.found = {} if self.renewed else steps

    def _text(self) -> str:
        lines = [
            f"# First hour with {self._robot.name}",
            "",
            f"- limber {__version__}; {platform.platform()}, {platform.machine()}",
            f"- {self._robot.folder}, robot.yaml and URDF: sha256 {self._digest[:16]}",
            f"- control rate {self._robot.rate_hz:g} Hz; "
            + ", ".join(f"bus {name}: {address}" for name, address in self._robot.buses.items()),
        ]
        for step, found in self.found.items():
            lines += ["", f"## {step}: {found.verdict}", "", f"{found.when}", ""]
            lines += ["```", *found.lines, "```"] if found.lines else []
            lines += ["", f"To do: {found.cure}"] if found.cure else []
        return "\n".join(lines) + "\n"


def _digest(robot: Robot) -> str:
    digest = hashlib.sha256()
    for path in (robot.folder / "robot.yaml", robot.urdf):
        digest.update(path.read_bytes())
    return digest.hexdigest()
