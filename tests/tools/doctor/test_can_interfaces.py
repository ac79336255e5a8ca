"""How doctor says to bring a bus up, and what it finds wrong with one that is there."""

import pytest

from limber.doctor import can_interfaces, machine
from limber.doctor.can_interfaces import BusNeeds, compare, lines_to_bring_up, needs_of

FD = BusNeeds("socketcan:can3", 1_000_000, 5_000_000, 0.0)
CLASSIC = BusNeeds("virtual:x", 500_000, None, 0.0)


def test_the_whole_line():
    assert FD.bring_up("can3") == (
        "sudo ip link set can3 type can bitrate 1000000 dbitrate 5000000 fd on restart-ms 100 && "
        "sudo ip link set can3 txqueuelen 64 up"
    )
    assert CLASSIC.bring_up("can0") == (
        "sudo ip link set can0 type can bitrate 500000 restart-ms 100 && "
        "sudo ip link set can0 txqueuelen 64 up"
    )


def test_moteus_drives_want_their_sample_points():
    assert (
        needs_of("planar2r")["arm"]
        .bring_up("can0")
        .startswith(
            "sudo ip link set can0 type can bitrate 1000000 sample-point 0.666 dbitrate 5000000 "
            "dsample-point 0.666 fd on"
        )
    )
    assert not needs_of("openarm")["arm"].sample_point


def test_every_shipped_robot_is_in_one_of_the_lines():
    lines = dict(lines_to_bring_up(None))
    names = [name for buses in lines for name in buses.split(", ")]
    assert len(names) == len(set(names)) and {"openarm", "desktop2r", "iiwa14"} <= set(names)
    (classic,) = [line for buses, line in lines.items() if "desktop2r" in buses.split(", ")]
    assert "fd on" not in classic and "canX" in classic


@pytest.fixture
def interface(tmp_path, monkeypatch):
    """Makes can3 as sysfs shows it."""
    monkeypatch.setattr(can_interfaces, "SYSFS", tmp_path)

    def make(up: bool, queue: int, **link) -> None:
        folder = tmp_path / "can3"
        folder.mkdir()
        (folder / "type").write_text("280\n")
        (folder / "flags").write_text("0x40081\n" if up else "0x40080\n")
        (folder / "tx_queue_len").write_text(f"{queue}\n")
        monkeypatch.setattr(can_interfaces, "link_data", lambda _name: link)

    return make


def bring_up_finding(monkeypatch):
    monkeypatch.setattr(can_interfaces, "needs_of", lambda _robot: {"arm": FD})
    return next(finding for finding in machine._can("any") if finding.subject == "can3")


def test_missing(tmp_path, monkeypatch):
    monkeypatch.setattr(can_interfaces, "SYSFS", tmp_path)
    finding = bring_up_finding(monkeypatch)
    assert finding.level == "warn" and "no such interface" in finding.text
    assert finding.cure == FD.bring_up("can3")


def test_down(interface, monkeypatch):
    interface(up=False, queue=10)
    finding = bring_up_finding(monkeypatch)
    assert "is down" in finding.text and "queue of 10" in finding.text
    assert finding.cure == f"sudo ip link set can3 down && {FD.bring_up('can3')}"


def test_fit_for_use(interface, monkeypatch):
    interface(up=True, queue=64)
    assert bring_up_finding(monkeypatch).level == "ok"


def test_settings_that_differ_from_robot_yaml():
    good = {
        "bittiming": {"bitrate": 1_000_000},
        "data_bittiming": {"bitrate": 5_000_000},
        "ctrlmode": ["FD"],
        "restart_ms": 100,
        "state": "ERROR-ACTIVE",
    }
    assert compare(FD, good) == []
    assert compare(FD, {}) == []  # vcan has none
    assert compare(FD, good | {"bittiming": {"bitrate": 500_000}}) == [
        "bit rate 500000, robot.yaml has 1000000"
    ]
    assert compare(FD, good | {"data_bittiming": {"bitrate": 2_000_000}}) == [
        "data bit rate 2000000, robot.yaml has 5000000"
    ]
    assert compare(FD, good | {"ctrlmode": []}) == ["CAN-FD is off"]
    assert "restart-ms is 0" in compare(FD, good | {"restart_ms": 0})[0]
    assert "BUS-OFF" in compare(FD, good | {"state": "BUS-OFF"})[0]
