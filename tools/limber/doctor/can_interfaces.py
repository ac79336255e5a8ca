"""CAN interfaces and serial adapters of this machine, against what robot.yaml asks of its buses."""

import json
import os
import shutil
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from limber.model.protocols import protocol
from limber.model.robot import load_robot
from limber.paths import robot_names

TX_QUEUE = 64  # frames: more than a cycle of the largest arm
RESTART_MS = 100  # after bus-off
SYSFS = Path("/sys/class/net")
ARPHRD_CAN = "280"  # linux/if_arp.h


@dataclass(frozen=True)
class BusNeeds:
    """What one bus of a robot.yaml asks of an interface; bit rates in bit/s."""

    address: str
    bitrate: int
    data_bitrate: int | None  # None: classic CAN
    sample_point: float  # that its drives want; 0: any

    @property
    def interface(self) -> str | None:
        """None of a virtual bus."""
        kind, _, name = self.address.partition(":")
        return name if kind == "socketcan" else None

    @property
    def device(self) -> Path | None:
        """The serial line of an adapter that the kernel does not drive."""
        kind, _, place = self.address.partition(":")
        return Path(place.partition("@")[0]) if kind in ("slcan", "dmserial") else None

    @property
    def hardware(self) -> tuple:
        """Buses that are brought up alike have this in common."""
        return self.bitrate, self.data_bitrate, self.sample_point

    def cure(self) -> str:
        """Of what is wrong with it: the commands."""
        if self.device is not None:
            return (
                "plug it in: ls /dev/serial/by-id lists serial adapters by names that stay; "
                "permission: sudo usermod -aG dialout $USER, then log in again"
            )
        return self.bring_up(self.interface or "canX")

    def bring_up(self, name: str) -> str:
        """The commands that bring an adapter up, on one line."""
        words = ["type can bitrate", str(self.bitrate)]
        if self.sample_point:
            words += ["sample-point", str(self.sample_point)]
        if self.data_bitrate:
            words += ["dbitrate", str(self.data_bitrate)]
            if self.sample_point:
                words += ["dsample-point", str(self.sample_point)]
            words += ["fd on"]
        words += ["restart-ms", str(RESTART_MS)]
        return (
            f"sudo ip link set {name} {' '.join(words)} && "
            f"sudo ip link set {name} txqueuelen {TX_QUEUE} up"
        )


def needs_of(robot: str) -> dict[str, BusNeeds]:
    """Bus name -> needs."""
    found = load_robot(robot).resolved
    sample_points = {
        joint["bus"]: protocol(joint["protocol"]).sample_point for joint in found["joints"]
    }
    return {bus["name"]: _needs(bus, sample_points.get(bus["name"], 0.0)) for bus in found["buses"]}


def _needs(bus: dict[str, Any], sample_point: float) -> BusNeeds:
    data_bitrate = int(bus["data_bitrate_bps"]) if bus["fd"] else None
    return BusNeeds(bus["can"], int(bus["bitrate_bps"]), data_bitrate, sample_point)


def lines_to_bring_up(robot: str | None) -> Iterator[tuple[str, str]]:
    """(buses, command) for one robot, or for all that are shipped, those that are alike as one."""
    alike: dict[tuple, tuple[BusNeeds, list[str]]] = {}
    for name in [robot] if robot else robot_names():
        for bus, needs in needs_of(name).items():
            if needs.device is not None:
                continue
            where = Path(name).name if robot is None else f"{Path(name).name} {bus}"
            key = (needs.hardware, needs.interface)
            names = alike.setdefault(key, (needs, []))[1]
            if where not in names:
                names.append(where)
    for needs, names in alike.values():
        yield ", ".join(names), needs.bring_up(needs.interface or "canX")


def present() -> list[Path]:
    """Folders in sysfs of all CAN interfaces."""
    types = sorted(SYSFS.glob("*/type"))
    return [path.parent for path in types if path.read_text().strip() == ARPHRD_CAN]


def problems(needs: BusNeeds) -> list[str]:
    """What is wrong with what a bus names; nothing if it is fit for use."""
    if needs.device is not None:
        return serial_problems(needs.device)
    name = needs.interface
    assert name is not None
    folder = SYSFS / name
    if not (folder / "type").exists():
        return ["there is no such interface"]
    found = []
    if not int((folder / "flags").read_text(), 16) & 1:
        found.append("is down")
    queue = int((folder / "tx_queue_len").read_text())
    if queue < TX_QUEUE:
        found.append(f"its queue of {queue} frames refuses a burst")
    return found + compare(needs, link_data(name))


def serial_problems(device: Path) -> list[str]:
    if not device.exists():
        return ["there is no such device"]
    return [] if os.access(device, os.R_OK | os.W_OK) else ["no permission to open it"]


def link_data(name: str) -> dict[str, Any]:
    """What the kernel knows of an adapter's bit timing; empty for vcan, or without iproute2."""
    ip = shutil.which("ip", path="/usr/sbin:/sbin:/usr/bin:/bin")
    if ip is None:
        return {}
    command = [ip, "-details", "-json", "link", "show", "dev", name]
    shown = subprocess.run(command, capture_output=True, text=True, check=False)
    try:
        info = json.loads(shown.stdout)[0].get("linkinfo", {})
    except (json.JSONDecodeError, IndexError, AttributeError):
        return {}
    return info.get("info_data", {}) if info.get("info_kind") == "can" else {}


def compare(needs: BusNeeds, link: dict[str, Any]) -> list[str]:
    """Differences between robot.yaml and the adapter's settings."""
    if not link:
        return []
    found = []
    rate = link.get("bittiming", {}).get("bitrate")
    if rate is not None and rate != needs.bitrate:
        found.append(f"bit rate {rate}, robot.yaml has {needs.bitrate}")
    fd = "FD" in link.get("ctrlmode", [])
    if needs.data_bitrate and not fd:
        found.append("CAN-FD is off")
    data_rate = link.get("data_bittiming", {}).get("bitrate")
    if needs.data_bitrate and fd and data_rate not in (None, needs.data_bitrate):
        found.append(f"data bit rate {data_rate}, robot.yaml has {needs.data_bitrate}")
    if not link.get("restart_ms"):
        found.append("restart-ms is 0: bus-off lasts until somebody restarts it")
    if link.get("state") in ("ERROR-WARNING", "ERROR-PASSIVE", "BUS-OFF"):
        found.append(f"state {link['state']}: wiring, termination or bit rate")
    return found
