"""docs/client.md against the docstrings, and what `import limber` costs."""

import inspect
import subprocess
import sys

import pytest

import limber
from limber_qa import python_doc


def test_the_page_is_that_of_the_docstrings():
    text = python_doc.TABLE.path.read_text(encoding="utf-8")
    assert python_doc.TABLE.updated(text) == text, "run: ./limber dev docs"


def test_every_public_call_has_a_docstring():
    for owner in (*python_doc.CALLS.values(), python_doc.Quantities, *python_doc.OTHERS):
        for name, member in vars(owner).items():
            if not name.startswith("_") and (inspect.isfunction(member) or callable(member)):
                assert inspect.getdoc(member), f"{owner.__name__}.{name}"


def test_importing_limber_is_light():
    code = (
        "import limber, sys; print(sorted({'numpy', 'lcm', 'scipy', 'typer'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_names_are_loaded_when_they_are_used():
    stub = (python_doc.ROOT / "tools" / "limber" / "__init__.pyi").read_text(encoding="utf-8")
    for name in limber.__all__:
        assert getattr(limber, name) is not None
        assert name in stub
    with pytest.raises(AttributeError, match="no attribute 'Leg'"):
        _ = limber.Leg
