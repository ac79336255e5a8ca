"""udev rules that name CAN adapters for good, and systemd-networkd's files that bring them up.

An adapter is told from others by its USB serial number; where two have the same one, as some are
sold, or none, by the place where it is plugged in.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

from rich.console import Console

from limber.doctor.can_interfaces import RESTART_MS, TX_QUEUE, BusNeeds, needs_of, present
from limber.errors import InputError
from limber.model.robot import load_robot
from limber.output import write_again
from limber.paths import output_folder

SERIAL = Path("/sys/class/tty")
LONGEST = 15  # characters of an interface's name
KERNELS_OWN = re.compile(r"(v|sl)?can\d+")  # names that the kernel gives to whoever comes first
NET, TTY = "net", "tty"
CHANNEL = ("dev_id", "dev_port")  # of several interfaces of one adapter

STEPS = """
  sudo cp {out}/*.rules /etc/udev/rules.d/ && sudo udevadm control --reload
{networkd}  then unplug the adapters and plug them in again, and in robot.yaml:
{addresses}
"""
NETWORKD = """  sudo cp {out}/*.network /etc/systemd/network/
  sudo systemctl enable --now systemd-networkd && sudo networkctl reload
"""


@dataclass(frozen=True)
class Adapter:
    """One interface or serial line of this machine, and the device that it belongs to."""

    subsystem: str
    place: str  # the kernel's name of the device: 1-2.3 at USB, 0000:03:00.0, spi0.0
    usb: tuple[str, str, str] | None  # vendor, product, serial number
    channel: tuple[tuple[str, str], ...] = ()

    def rule(self, name: str, by_place: bool) -> str:
        """A line of udev(7)."""
        matches = [f'SUBSYSTEM=="{self.subsystem}"', 'ACTION=="add"']
        if self.usb and not by_place:
            keys = ("idVendor", "idProduct", "serial")
            matches += [
                f'ATTRS{{{key}}}=="{value}"' for key, value in zip(keys, self.usb, strict=True)
            ]
        else:
            matches.append(f'KERNELS=="{self.place}"')
        matches += [f'ATTR{{{key}}}=="{value}"' for key, value in self.channel]
        if self.subsystem == TTY:
            return ", ".join([*matches, f'SYMLINK+="{name}"'])
        return ", ".join([*matches, f'NAME="{name}"', f'ATTR{{tx_queue_len}}="{TX_QUEUE}"'])


def adapters() -> dict[tuple[str, str], Adapter]:
    """(subsystem, name) -> all that may carry CAN."""
    lines = sorted([*SERIAL.glob("ttyACM*"), *SERIAL.glob("ttyUSB*")])
    entries = [(NET, entry) for entry in present()] + [(TTY, entry) for entry in lines]
    made = {(kind, entry.name): _adapter(kind, entry) for kind, entry in entries}
    return {key: adapter for key, adapter in made.items() if adapter is not None}


def _adapter(subsystem: str, entry: Path) -> Adapter | None:
    if not (entry / "device").exists():
        return None  # a virtual interface
    device = (entry / "device").resolve()
    channel = tuple((key, _text(entry / key)) for key in CHANNEL if (entry / key).exists())
    for folder in (device, *device.parents):
        if (folder / "idVendor").exists():
            vendor, product, serial = (
                _text(folder / key) for key in ("idVendor", "idProduct", "serial")
            )
            return Adapter(subsystem, folder.name, (vendor, product, serial), channel)
    return Adapter(subsystem, device.name, None, channel)


def _text(path: Path) -> str:
    return path.read_text(encoding="utf-8").strip() if path.exists() else ""


def alike(adapter: Adapter, others: Iterable[Adapter]) -> list[str]:
    """The places of all adapters that a rule for this one would fit."""
    if not adapter.usb:
        return [adapter.place]
    return sorted({other.place for other in others if other.usb == adapter.usb})


def write(robot: str, addresses: dict[str, str], out: Path, console: Console) -> None:
    """`addresses`: of the robot's buses, as their adapters are called now."""
    arm = load_robot(robot).name
    here = adapters()
    rules = [f"# CAN adapters of {arm}: to /etc/udev/rules.d/"]
    files, lines = {}, []
    for bus, needs in needs_of(robot).items():
        used = replace(needs, address=addresses[bus])
        adapter = _of(bus, used, here)
        name = _name(arm, bus, used)
        places = alike(adapter, here.values())
        by_place = len(places) > 1 or not (adapter.usb and adapter.usb[2])
        if by_place and adapter.usb:
            same = f"{len(places)} adapters have one serial number"
            why = same if len(places) > 1 else "its adapter has no serial number"
            rules.append(f"# {name}: {why}: the one that is plugged in at {adapter.place}")
            console.print(
                f"[yellow]{name}: {why}; it keeps its name at this port only[/]", soft_wrap=True
            )
        rules.append(adapter.rule(name, by_place))
        if used.interface is None:
            kind = used.address.partition(":")[0]
            lines.append(f"    {bus}: {{can: {kind}:/dev/{name}}}")
        else:
            files[f"80-{name}.network"] = network(name, used)
            lines.append(f"    {bus}: {{can: socketcan:{name}}}")
    files[f"70-limber-{arm}.rules"] = "\n".join(rules) + "\n"
    output_folder(out)
    for file, text in files.items():
        write_again(out / file, text)
        console.print(f"wrote {out / file}", soft_wrap=True)
    networkd = NETWORKD.format(out=out) if len(files) > 1 else ""
    steps = STEPS.format(out=out, networkd=networkd, addresses="\n".join(lines))
    console.print(steps, soft_wrap=True, highlight=False)


def _of(bus: str, needs: BusNeeds, here: dict[tuple[str, str], Adapter]) -> Adapter:
    if needs.device is not None:
        key = (TTY, needs.device.resolve().name)
    else:
        key = (NET, needs.interface or "")
    if key in here:
        return here[key]
    found = [f"socketcan:{name}" if kind == NET else f"/dev/{name}" for kind, name in here]
    raise InputError(
        f"bus {bus} is {needs.address}, which is no adapter of this machine (plugged in: "
        f"{', '.join(found) or 'none'}); plug it in and name it: --bus {bus}=socketcan:can0"
    )


def _name(arm: str, bus: str, needs: BusNeeds) -> str:
    """The interface's, unless the kernel would give it to another adapter."""
    name = needs.interface
    if name is not None and not KERNELS_OWN.fullmatch(name):
        return name
    tail = re.sub(r"[^a-z0-9_]", "_", bus.lower())[4 - LONGEST :]
    return f"{arm[: LONGEST - 1 - len(tail)]}_{tail}"


def network(name: str, needs: BusNeeds) -> str:
    """Of systemd.network(5)."""
    lines = ["[Match]", f"Name={name}", "", "[Link]", "RequiredForOnline=no", "", "[CAN]"]
    lines.append(f"BitRate={needs.bitrate}")
    sample_point = f"{100 * needs.sample_point:g}%" if needs.sample_point else ""
    if sample_point:
        lines.append(f"SamplePoint={sample_point}")
    if needs.data_bitrate:
        lines += ["FDMode=yes", f"DataBitRate={needs.data_bitrate}"]
        if sample_point:
            lines.append(f"DataSamplePoint={sample_point}")
    lines.append(f"RestartSec={RESTART_MS}ms")
    return "\n".join(lines) + "\n"
