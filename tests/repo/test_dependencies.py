"""Every package that limber imports is one that pyproject.toml names: what only a test's package
brings along is missing for everybody else.
"""

import ast
import re
import sys
import tomllib
from importlib import metadata

from limber.paths import LACKING, ROOT

COMES_WITH = {"trimesh": "viser", "websockets": "viser"}
CALLED = {
    "google": "protobuf",
    "foxglove": "foxglove-sdk",
    "rerun": "rerun-sdk",
    "yaml": "pyyaml",
}  # in pyproject.toml


def package(requirement: str) -> str:
    """Of "python-can>=4.4,<5"."""
    return re.split("[^A-Za-z0-9_.-]", requirement)[0].lower()


def imported(source: str) -> set[str]:
    """Other people's modules that it imports when it runs, not only for the type checker."""
    found: set[str] = set()
    nodes: list[ast.AST] = [ast.parse(source)]
    while nodes:
        node = nodes.pop()
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            continue
        if isinstance(node, ast.Import):
            found |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            found.add(node.module.partition(".")[0])
        nodes += ast.iter_child_nodes(node)
    return found - {"limber", *sys.stdlib_module_names}


def test_what_is_imported_is_named():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    users = ("identify", "mcap", "can", "parquet", "sweep", "rerun", "gym", "ros2", "foxglove")
    needed = [*project["dependencies"], *(line for extra in users for line in extras[extra])]
    assert set(LACKING.values()) <= set(needed), "what the Debian package has pip install"
    named = {package(requirement) for requirement in needed}
    for path in sorted((ROOT / "tools" / "limber").rglob("*.py")):
        for module in imported(path.read_text(encoding="utf-8")):
            where = COMES_WITH.get(module) or CALLED.get(module, module)
            assert where in named, f"{path}: {module}"


def test_what_comes_with_another_does():
    for module, other in COMES_WITH.items():
        assert module in {package(requirement) for requirement in metadata.requires(other) or ()}
