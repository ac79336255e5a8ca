"""The systemd units: what systemd itself thinks of them, and what they are refused for."""

import shutil
import subprocess

import pytest

from limber.errors import InputError
from limber.paths import program
from limber.run.service import drop_ins, shared_files

REAL = ("arm=socketcan:can0",)
DRIVER, CONTROLLER = (
    f"limber-{role}@openarm.service.d/robot.conf" for role in ("driver", "controller")
)


def test_systemd_takes_the_units(tmp_path):
    verify = shutil.which("systemd-analyze")
    if verify is None:
        pytest.skip("no systemd on this machine")
    texts = shared_files() | drop_ins("openarm", REAL)
    for name, text in texts.items():
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        # An installed program, at the place that the package installs it to
        path.write_text(
            text.replace("/usr/bin/limber-", f"{program('limber-driver').parent}/limber-")
        )
    units = [f"limber-{role}@openarm.service" for role in ("driver", "controller")]
    for unit in (*units, "limber@openarm.target"):
        shutil.copy(tmp_path / unit.replace("openarm", ""), tmp_path / unit)
    paths = [str(tmp_path / name) for name in (*units, "limber@openarm.target")]
    done = subprocess.run([verify, "verify", *paths], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    ours = [line for line in done.stderr.splitlines() if "limber" in line]
    assert ours == []


def test_only_the_driver_may_open_can_sockets():
    units = shared_files()
    assert " AF_CAN" in units["limber-driver@.service"]
    assert " AF_CAN" not in units["limber-controller@.service"]


def test_both_are_told_the_same_arm_plane_in_the_folder_that_is_made():
    units = shared_files()
    for role in ("driver", "controller"):
        unit = units[f"limber-{role}@.service"]
        assert "LIMBER_ARM_URL=unix:/run/limber/%i\n" in unit
        assert f"User=limber-{role}" in unit
        assert f"u limber-{role} " in units["limber.sysusers.conf"]
    assert "d /run/limber 0770 " in units["limber.tmpfiles.conf"]


def test_both_differ_in_program_account_and_sockets_alone():
    units = shared_files()
    as_driver = units["limber-controller@.service"].replace("controller", "driver")
    assert as_driver.replace("NETLINK", "NETLINK AF_CAN") == units["limber-driver@.service"]


def test_the_drop_in_names_robot_buses_and_the_device_to_wait_for():
    found = drop_ins("openarm", REAL)
    assert "After=sys-subsystem-net-devices-can0.device" in found[DRIVER]
    assert '/openarm" --realtime --bus arm=socketcan:can0' in found[DRIVER]
    assert "device" not in found[CONTROLLER] and '/openarm" --realtime\n' in found[CONTROLLER]


def test_an_interface_with_a_dash_is_named_as_systemd_names_it():
    found = drop_ins("openarm", ("arm=socketcan:can-left",))
    assert "devices-can\\x2dleft.device" in found[DRIVER]


def test_a_simulated_bus_is_refused():
    with pytest.raises(InputError, match="arm=socketcan:INTERFACE"):
        drop_ins("openarm")
