"""Code in the docs is code: commands with their options, Python with its names, YAML."""

import ast
import inspect
import re
import shlex
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
import yaml
from test_docs import ROOT, pages
from typer.main import get_command

from limber import Arm
from limber.cli.main import app
from limber.cli.panels import SHORTER
from limber.paths import program

BLOCK = re.compile(r"^```(\w*)\n(.*?)^```", re.DOTALL | re.MULTILINE)
PASSED_ON = ("eval",)  # its options are limber-eval's
TUTORIAL = "tutorial_own_law.md"  # followed step by step in tests/tutorial
IN_TREE = ("scenarios/", "robots/", "examples/", "lecture/", "qa/", "tests/")


def blocks(*languages: str) -> list[tuple[str, str]]:
    """Page with the block's number, and its text."""
    found = []
    for page in (page for page in pages() if page.name != TUTORIAL):
        for number, match in enumerate(BLOCK.finditer(page.read_text(encoding="utf-8")), 1):
            if match[1] in languages:
                found.append((f"{page.relative_to(ROOT)} block {number}", match[2]))
    return found


def commands() -> Iterator[tuple[str, str]]:
    """Lines that call limber, and calls between backquotes, without the comment behind them."""
    for where, text in blocks("", "sh", "bash"):
        for line in text.replace("\\\n", " ").splitlines():
            if re.match(r"(\./)?limber [a-z]", line):
                yield where, re.split(r"\s{2,}#| # ", line)[0].strip()
    for page in pages():
        if page.name == "CHANGELOG.md":
            continue  # names commands as they were called
        text = BLOCK.sub("", page.read_text(encoding="utf-8"))
        for match in re.finditer(r"`((?:\./)?limber [a-z][^`]*)`", text):
            yield str(page.relative_to(ROOT)), match[1]


def complaint(line: str) -> str | None:
    """What is wrong with a call: a command or option that does not exist, a file that is not there.

    Words in capitals stand for what a user puts there; [..] for what may be left out.
    """
    try:
        words = shlex.split(re.sub(r"[\[\]]", " ", line.split(" | ")[0].split(" > ")[0]))[1:]
    except ValueError as error:
        return str(error)
    words = [*SHORTER.get(words[0], words[0]).split(), *words[1:]]
    command = get_command(app)
    while words and hasattr(command, "commands"):
        found = command.commands.get(words[0])
        if found is None:
            return None if words[0].isupper() or words[0] in ("...", "…") else f"no {words[0]}"
        command, words = found, words[1:]
    if command.name in PASSED_ON:
        return None
    options = {name for param in command.params for name in (*param.opts, *param.secondary_opts)}
    for word in words:
        if word.startswith("--") and word.split("=")[0] not in {*options, "--help"}:
            return f"no option {word}"
        if word.startswith(IN_TREE) and not (ROOT / word).exists():
            return f"no file {word}"
    return None


def test_there_are_commands():
    assert len(list(commands())) > 60


@pytest.mark.parametrize(("where", "line"), sorted(set(commands())))
def test_every_command_exists_with_its_options(where, line):
    assert complaint(line) is None, f"{where}: {line}: {complaint(line)}"


@pytest.mark.parametrize(
    "line",
    ["./limber dmeo", "./limber run x.yaml --bsu a", "./limber lab scenarios/none.yaml"],
)
def test_a_wrong_command_is_found(line):
    assert complaint(line) is not None


@pytest.mark.parametrize(("where", "text"), blocks("python"))
def test_python_parses_and_calls_what_there_is(where, text):
    for node in ast.walk(ast.parse(text)):
        of_arm = isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name)
        if of_arm and node.value.id == "arm":
            assert hasattr(Arm, node.attr), f"{where}: arm.{node.attr}"
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            if not (isinstance(node.func.value, ast.Name) and node.func.value.id == "arm"):
                continue
            call = getattr(Arm, node.func.attr)
            if isinstance(call, property):  # what it returns is called
                call = inspect.signature(call.fget).return_annotation.__call__
            signature = inspect.signature(call)
            given = {key.arg: None for key in node.keywords if key.arg}
            signature.bind(None, *node.args, **given)


@pytest.mark.parametrize(("where", "text"), blocks("yaml"))
def test_yaml_parses_and_whole_scenarios_are_right(where, text, tmp_path):
    content = yaml.safe_load(text)
    assert isinstance(content, dict | list), where  # some blocks show the inside of an entry alone
    if isinstance(content, dict) and str(content.get("format")).startswith("limber-scenario"):
        path: Path = tmp_path / "scenario.yaml"
        path.write_text(text)
        done = subprocess.run(
            [program("limber-check"), "scenario", path], capture_output=True, text=True
        )
        assert done.returncode == 0, f"{where}: {done.stderr}"


def programs() -> Iterator[tuple[str, str]]:
    """Every command with the example in its help."""

    def below(command, name: str) -> Iterator[tuple[str, str]]:
        for word, found in getattr(command, "commands", {}).items():
            yield from below(found, f"{name} {word}")
        if not hasattr(command, "commands"):
            yield name, command.epilog or ""

    return below(get_command(app), "limber")


@pytest.mark.parametrize(("name", "told"), list(programs()))
def test_every_command_has_an_example_that_is_right(name, told):
    if name.split()[-1] in PASSED_ON:
        return  # the help is limber-eval's own
    words = name.removeprefix("limber ")
    short = [
        words.replace(there, here, 1) for here, there in SHORTER.items() if words.startswith(there)
    ]
    assert told.startswith(tuple(f"Example: limber {known}" for known in (words, *short)))
    line = told.removeprefix("Example: ")
    assert complaint(line) is None
