"""The systemd units: what systemd itself thinks of them, and what they are refused for."""

import shutil
import subprocess

import pytest

from limber.errors import InputError
from limber.run.service import files

REAL = ("arm=socketcan:can0",)


def test_systemd_takes_the_units(tmp_path):
    verify = shutil.which("systemd-analyze")
    if verify is None:
        pytest.skip("no systemd on this machine")
    units = {name: text for name, text in files("openarm", REAL).items() if "conf" not in name}
    assert len(units) == 3
    for name, text in units.items():
        (tmp_path / name).write_text(text)
    paths = [str(tmp_path / name) for name in units]
    done = subprocess.run([verify, "verify", *paths], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    ours = [line for line in done.stderr.splitlines() if "limber" in line]
    assert ours == []


def test_only_the_driver_may_open_can_sockets():
    units = files("openarm", REAL)
    assert " AF_CAN" in units["limber-openarm-driver.service"]
    assert " AF_CAN" not in units["limber-openarm-controller.service"]


def test_both_are_told_the_same_arm_plane_in_the_folder_that_is_made():
    units = files("openarm", REAL)
    for role in ("driver", "controller"):
        unit = units[f"limber-openarm-{role}.service"]
        assert "LIMBER_ARM_URL=unix:/run/limber-openarm/arm" in unit
        assert f"User=limber-{role}" in unit
    assert "d /run/limber-openarm 0770 " in units["limber-openarm.tmpfiles.conf"]


def test_an_interface_with_a_dash_is_named_as_systemd_names_it():
    units = files("openarm", ("arm=socketcan:can-left",))
    assert "devices-can\\x2dleft.device" in units["limber-openarm-driver.service"]


def test_a_simulated_bus_is_refused():
    with pytest.raises(InputError, match="arm=socketcan:INTERFACE"):
        files("openarm")
