"""LeRobot itself, in an environment of its own (5 GB): build/lerobot, made with Python 3.12 or uv,
else with this Python; or that of the Python that LIMBER_LEROBOT names.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from other_python import make_environment
from own_network import leave_the_machines_network

from limber.paths import ROOT

NEWEST, FOR_311 = "lerobot[async,damiao,dataset]==0.6.1", "lerobot[async,damiao]==0.4.4"


@pytest.fixture(scope="session")
def python():
    """LeRobot's; this process has left the machine's network."""
    found = _installed()
    leave_the_machines_network()
    return found


@pytest.fixture
def home(tmp_path):
    """LeRobot's: calibrations, logs, what its commands print."""
    folder = tmp_path / "home"
    folder.mkdir()
    return folder


def _installed() -> Path:
    if "LIMBER_LEROBOT" in os.environ:
        return Path(os.environ["LIMBER_LEROBOT"])
    folder = ROOT / "build" / "lerobot"
    found = folder / "bin" / "python"
    if not found.exists():
        lerobot = NEWEST
        if not make_environment(folder, "3.12"):
            lerobot = FOR_311
            subprocess.run([sys.executable, "-m", "venv", folder], check=True)
        # python-can takes msgpack for udp_multicast.
        subprocess.run([found, "-m", "pip", "install", "-q", lerobot, "msgpack"], check=True)
    plug_in = ROOT / "integrations" / "lerobot"
    subprocess.run([found, "-m", "pip", "install", "-q", "--no-deps", "-e", plug_in], check=True)
    return found
