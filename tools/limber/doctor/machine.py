"""`limber doctor`: checks what often goes wrong on a new machine, and names the cure."""

import os
import platform
import resource
import shutil
import socket
import subprocess
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

from limber import __version__, paths
from limber.doctor import can_interfaces
from limber.live import network

WANTED_BUFFER_BYTES = 2 << 20
RECORDER_BUFFER_BYTES = 64 << 20
WANTED_PRIORITY = 80
LIMITS_FILE = paths.ASSETS / "service" / "limber.limits.conf"
LIMITS = (
    f"sudo cp {LIMITS_FILE} /etc/security/limits.d/limber.conf; sudo groupadd -f limber; "
    "sudo usermod -aG limber $USER, and log in again"
)
MEMBER = "sudo usermod -aG limber $USER, and log in again"  # of the Debian package's group
SMALL_DISK_BYTES = 1 << 30
PROGRAMS = tuple(
    f"limber-{name}"
    for name in (
        *("driver", "controller", "sim", "lab", "check"),
        *("record", "send", "can", "motors"),
    )
)


@dataclass(frozen=True)
class Finding:
    """`level`: ok, warn (works, but not as well as it could) or fail (limber will not run)."""

    level: str
    subject: str
    text: str
    cure: str = ""


def _multicast() -> Iterator[Finding]:
    if network.multicast_works():
        yield Finding("ok", "multicast", "a datagram to LCM's group arrives")
    elif network.private_command():
        text = "no multicast route; runs go to a private network that other terminals cannot see"
        yield Finding("warn", "multicast", text, network.CURE)
    else:
        yield Finding("fail", "multicast", "no multicast route: LCM cannot start", network.CURE)


def _receive_buffer() -> Iterator[Finding]:
    granted = int(Path("/proc/sys/net/core/rmem_max").read_text())
    text = f"net.core.rmem_max is {granted} bytes"
    if granted >= WANTED_BUFFER_BYTES:
        yield Finding("ok", "receive buffer", text)
    else:
        text += ": at 1 kHz a pause of 0.2 s loses messages"
        yield Finding(
            "warn",
            "receive buffer",
            text,
            f"sudo sysctl -w net.core.rmem_max={RECORDER_BUFFER_BYTES}",
        )


def _limit(which: int) -> float:
    soft = resource.getrlimit(which)[0]
    return float("inf") if soft == resource.RLIM_INFINITY else soft


def _has_capabilities() -> bool:
    if os.geteuid() == 0:
        return True
    getcap, driver = shutil.which("getcap", path="/usr/sbin:/sbin:/usr/bin"), _driver()
    if getcap is None or driver is None:
        return False
    capabilities = subprocess.run(
        [getcap, str(driver)], capture_output=True, text=True, check=False
    )
    return "cap_sys_nice" in capabilities.stdout


def _driver() -> Path | None:
    path = paths.programs_folder() / "limber-driver"
    return path if path.exists() else None


def _permission() -> str:
    """How SCHED_FIFO and locked memory become permitted. A program with capabilities does not find
    libraries relative to itself, as those of an installed package are.
    """
    if paths.IN_A_CLONE:
        driver = paths.programs_folder() / "limber-driver"
        return f"sudo setcap cap_sys_nice,cap_ipc_lock+ep {driver}, or {LIMITS}"
    return MEMBER if paths.FROM_DEBIAN else LIMITS


def _real_time() -> Iterator[Finding]:
    if _has_capabilities() or _limit(resource.RLIMIT_RTPRIO) >= WANTED_PRIORITY:
        yield Finding("ok", "real time", "SCHED_FIFO may be used")
    else:
        text = "SCHED_FIFO is not permitted: cycles will start late under load"
        yield Finding("warn", "real time", text, _permission())
    locked = _limit(resource.RLIMIT_MEMLOCK)
    if _has_capabilities() or locked > 256 << 20:
        yield Finding("ok", "locked memory", "memory may be locked")
    else:
        text = f"only {locked / 1024:.0f} KiB may be locked: a page fault can make a cycle late"
        yield Finding("warn", "locked memory", text, _permission())
    flavour = Path("/sys/kernel/realtime")
    kernel = (
        "PREEMPT_RT" if flavour.exists() else "not PREEMPT_RT (good enough for a simulated arm)"
    )
    yield Finding("ok", "kernel", f"{platform.release()}, {kernel}")


def _can(robot: str | None) -> Iterator[Finding]:
    try:
        socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW).close()
    except OSError:
        text = "this kernel has none: simulated arms work (virtual: buses), real ones do not"
        yield Finding("warn", "SocketCAN", text, "sudo modprobe can_raw vcan, or another kernel")
    else:
        yield Finding("ok", "SocketCAN", "the kernel has it")
    used = {} if robot is None else can_interfaces.needs_of(robot)
    wanted = [needs for needs in used.values() if needs.interface]
    yield from _other_interfaces({needs.interface for needs in wanted})
    for needs in wanted:
        yield _bus_interface(needs)
    for needs in used.values():
        if needs.device is not None:
            yield _serial_adapter(needs)
    for buses, command in can_interfaces.lines_to_bring_up(robot):
        yield Finding("ok", "bring-up", f"an adapter for {buses}: {command}")


def _other_interfaces(but: set[str | None]) -> Iterator[Finding]:
    """Those here that no robot in question names."""
    found = can_interfaces.present()
    if not found and not but:
        yield Finding("ok", "CAN interface", "none here: fine for a simulated arm")
    for interface in found:
        if interface.name not in but:
            yield _can_interface(interface)


def _can_interface(interface: Path) -> Finding:
    name = interface.name
    queue = int((interface / "tx_queue_len").read_text())
    up = int((interface / "flags").read_text(), 16) & 1
    if not up:
        cure = f"an adapter: the line below; a vcan: sudo ip link set {name} up"
        return Finding("warn", name, "is down", cure)
    if queue < can_interfaces.TX_QUEUE:
        cure = f"sudo ip link set {name} txqueuelen {can_interfaces.TX_QUEUE}"
        return Finding("warn", name, f"queue of {queue} frames: a burst is refused", cure)
    return Finding("ok", name, f"up, queue of {queue} frames")


def _bus_interface(needs: can_interfaces.BusNeeds) -> Finding:
    wrong = can_interfaces.problems(needs)
    name = str(needs.interface)
    if not wrong:
        return Finding("ok", name, "up, as robot.yaml has it")
    down = "" if "there is no such interface" in wrong else f"sudo ip link set {name} down && "
    return Finding("warn", name, "; ".join(wrong), down + needs.bring_up(name))


def _serial_adapter(needs: can_interfaces.BusNeeds) -> Finding:
    wrong = can_interfaces.problems(needs)
    if wrong:
        return Finding("warn", needs.address, wrong[0], needs.cure())
    return Finding("ok", needs.address, "there, and may be opened")


def _programs() -> Iterator[Finding]:
    folder = paths.programs_folder()
    missing = [name for name in PROGRAMS if not (folder / name).exists()]
    if missing:
        yield Finding("fail", "programs", f"missing: {', '.join(missing)}", paths.REPAIR)
    else:
        yield Finding("ok", "programs", f"all {len(PROGRAMS)} in {folder}")
    others = f"Python {platform.python_version()}", f"numpy {metadata.version('numpy')}"
    versions = [f"limber {__version__}", *others]
    yield Finding("ok", "versions", ", ".join(versions))


def _disk() -> Iterator[Finding]:
    free = shutil.disk_usage(Path.cwd()).free
    text = f"{free / 1e9:.1f} GB free"
    if free < SMALL_DISK_BYTES:
        yield Finding("warn", "disk", f"{text}: a minute of log takes 0.2 GB", "make room")
    else:
        yield Finding("ok", "disk", text)


def examine(robot: str | None = None) -> list[Finding]:
    """`robot`: name or folder, for its buses; None: all that are shipped."""
    checks: tuple[Iterable[Finding], ...] = (
        _multicast(),
        _receive_buffer(),
        _real_time(),
        _can(robot),
        _programs(),
        _disk(),
    )
    return [finding for check in checks for finding in check]
