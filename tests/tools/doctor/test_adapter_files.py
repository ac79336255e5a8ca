"""What names adapters for good: udev rules and networkd's files, from a tree as sysfs has it."""

import pytest
from rich.console import Console

from limber.doctor import adapter_files, can_interfaces
from limber.errors import InputError

DESKTOP = "desktop2r"  # one classic bus, `arm`
PLANAR = "planar2r"  # one bus with CAN-FD, moteus' sample points


@pytest.fixture
def plug(tmp_path, monkeypatch):
    """Plugs an adapter in: an interface or a serial line at a USB port, or elsewhere."""
    monkeypatch.setattr(can_interfaces, "SYSFS", tmp_path / "class" / "net")
    monkeypatch.setattr(adapter_files, "SERIAL", tmp_path / "class" / "tty")

    def make(
        name: str, port: str, serial: str | None = None, usb: bool = True, **more: str
    ) -> None:
        device = tmp_path / "devices" / port / (f"{port}:1.0" if usb else "")
        device.mkdir(parents=True, exist_ok=True)
        if usb:
            (device.parent / "idVendor").write_text("1d50\n")
            (device.parent / "idProduct").write_text("606f\n")
            if serial is not None:
                (device.parent / "serial").write_text(f"{serial}\n")
        kind = "tty" if name.startswith("tty") else "net"
        entry = tmp_path / "class" / kind / name
        entry.mkdir(parents=True)
        (entry / "device").symlink_to(device)
        for key, value in ({"type": "280"} | more).items():
            (entry / key).write_text(f"{value}\n")

    return make


@pytest.fixture
def written(tmp_path):
    def write(robot: str, **addresses: str) -> tuple[dict[str, str], str]:
        """File -> text, and what was printed."""
        console = Console(width=200, record=True, quiet=False, file=open("/dev/null", "w"))  # noqa: SIM115
        adapter_files.write(robot, addresses, tmp_path / "out", console)
        files = {path.name: path.read_text() for path in (tmp_path / "out").iterdir()}
        return files, console.export_text()

    return write


def test_an_adapter_with_a_serial_number(plug, written):
    plug("can0", "1-2.3", "0039", dev_id="0x0", dev_port="0")
    files, printed = written(DESKTOP, arm="socketcan:can0")
    assert files["70-limber-desktop2r.rules"].splitlines()[1:] == [
        'SUBSYSTEM=="net", ACTION=="add", ATTRS{idVendor}=="1d50", ATTRS{idProduct}=="606f", '
        'ATTRS{serial}=="0039", ATTR{dev_id}=="0x0", ATTR{dev_port}=="0", NAME="desktop2r_arm", '
        'ATTR{tx_queue_len}="64"'
    ]
    assert files["80-desktop2r_arm.network"].split() == [
        "[Match]", "Name=desktop2r_arm", "[Link]", "RequiredForOnline=no", "[CAN]",
        "BitRate=1000000", "RestartSec=100ms",
    ]  # fmt: skip
    assert "arm: {can: socketcan:desktop2r_arm}" in printed and "networkctl reload" in printed


def test_two_adapters_of_one_serial_number_are_told_apart_by_their_ports(plug, written):
    plug("can0", "1-2.3", "SN0001")
    plug("can1", "1-2.4", "SN0001")
    files, printed = written(DESKTOP, arm="socketcan:can1")
    rule = files["70-limber-desktop2r.rules"].splitlines()[-1]
    assert 'KERNELS=="1-2.4"' in rule and "SN0001" not in rule
    assert "2 adapters have one serial number" in printed


def test_two_channels_of_one_adapter_are_told_apart_by_their_number(plug, written):
    for number in range(2):
        plug(f"can{number}", "1-2", "0039", dev_id=f"0x{number}", dev_port="0")
    rule = written(DESKTOP, arm="socketcan:can1")[0]["70-limber-desktop2r.rules"]
    assert 'ATTRS{serial}=="0039", ATTR{dev_id}=="0x1"' in rule and "KERNELS" not in rule


@pytest.mark.parametrize("serial", [None, ""])
def test_an_adapter_without_a_serial_number(plug, written, serial):
    plug("can0", "3-1", serial)
    files, printed = written(DESKTOP, arm="socketcan:can0")
    assert 'KERNELS=="3-1"' in files["70-limber-desktop2r.rules"]
    assert "no serial number" in printed


def test_an_adapter_that_is_not_at_usb(plug, written):
    plug("can0", "spi0.0", usb=False)
    files, printed = written(DESKTOP, arm="socketcan:can0")
    assert 'KERNELS=="spi0.0", NAME="desktop2r_arm"' in files["70-limber-desktop2r.rules"]
    assert "serial number" not in printed, "its place is all that there is"


def test_a_serial_line_gets_a_link_and_no_network(plug, written):
    plug("ttyACM0", "1-4", "77")
    files, printed = written(DESKTOP, arm="dmserial:/dev/ttyACM0@921600")
    assert list(files) == ["70-limber-desktop2r.rules"]
    assert 'SUBSYSTEM=="tty"' in files["70-limber-desktop2r.rules"]
    assert 'ATTRS{serial}=="77", SYMLINK+="desktop2r_arm"' in files["70-limber-desktop2r.rules"]
    assert "arm: {can: dmserial:/dev/desktop2r_arm}" in printed and "networkctl" not in printed


def test_a_name_of_ones_own_stays_and_fd_has_its_sample_points(plug, written):
    plug("left_arm", "1-2", "0039")
    files, _ = written(PLANAR, arm="socketcan:left_arm")
    assert 'NAME="left_arm"' in files["70-limber-planar2r.rules"]
    assert {
        "SamplePoint=66.6%",
        "FDMode=yes",
        "DataBitRate=5000000",
        "DataSamplePoint=66.6%",
    } <= set(files["80-left_arm.network"].split())


@pytest.mark.parametrize("address", ["virtual:desktop2r", "socketcan:can7", "slcan:/dev/ttyACM9"])
def test_what_is_not_plugged_in_is_refused_with_what_is(plug, written, address):
    plug("can0", "1-2", "0039")
    plug("eth0", "1-3", "0040", type="1")
    with pytest.raises(InputError, match=r"bus arm is .*plugged in: socketcan:can0\)"):
        written(DESKTOP, arm=address)
