"""`limber law new`: the first file of a law, which works as it is, and five lines of CMake."""

import re
from pathlib import Path

from limber.errors import InputError
from limber.output import write_new
from limber.paths import ASSETS, output_folder

NAME = re.compile(r"[a-z][a-z0-9_]{0,39}")
CMAKE = """\
cmake_minimum_required(VERSION 3.22)
project({name} LANGUAGES CXX)
find_package(limber REQUIRED)

limber_add_law({name} {name}.cc)
"""


def write(name: str, out: Path | None) -> list[Path]:
    """The files written. Raises InputError."""
    if not NAME.fullmatch(name):
        raise InputError(
            f"law name '{name}': expected a small letter, then small letters, digits and '_', at "
            "most 40"
        )
    folder = output_folder(out or Path(name))
    text = (ASSETS / "new_law.cc.in").read_text(encoding="utf-8")
    class_name = "".join(word.capitalize() for word in name.split("_"))
    contents = {
        f"{name}.cc": text.replace("new_law", name).replace("NewLaw", class_name),
        "CMakeLists.txt": CMAKE.format(name=name),
    }
    for file, content in contents.items():
        write_new(folder / file, content)
    return [folder / file for file in contents]
