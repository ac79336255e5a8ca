"""`limber test lint`: style of all Python by ruff, and types of the product's by mypy."""

import subprocess
import sys

from limber.paths import ROOT

TOOLS = (("ruff", "check", "."), ("mypy",))  # their settings are in pyproject.toml


def run() -> bool:
    """Both, also after the first has found something."""
    done = [subprocess.run([sys.executable, "-m", *tool], cwd=ROOT, check=False) for tool in TOOLS]
    return not any(each.returncode for each in done)


if __name__ == "__main__":
    sys.exit(0 if run() else 1)
