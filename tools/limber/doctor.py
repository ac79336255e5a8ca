"""`limber doctor`: looks at what trips people on a new machine, and says the cure."""

import os
import platform
import resource
import shutil
import socket
import subprocess
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

from limber import network, paths

WANTED_BUFFER_BYTES = 2 << 20
WANTED_PRIORITY = 80
WANTED_TXQUEUE = 64
SMALL_DISK_BYTES = 1 << 30
PROGRAMS = ("driver", "controller", "sim", "lab", "check", "record")


@dataclass(frozen=True)
class Finding:
    """`level`: ok, warn (works, but not as well as it could) or fail (limber will not run)."""

    level: str
    subject: str
    text: str
    cure: str = ""


def _multicast() -> Iterator[Finding]:
    if network.multicast_works():
        yield Finding("ok", "multicast", "a datagram to LCM's group comes back")
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
        yield Finding("warn", "receive buffer", text, "sudo sysctl -w net.core.rmem_max=4194304")


def _limit(which: int) -> float:
    soft = resource.getrlimit(which)[0]
    return float("inf") if soft == resource.RLIM_INFINITY else soft


def _has_capabilities() -> bool:
    if os.geteuid() == 0:
        return True
    getcap, driver = shutil.which("getcap", path="/usr/sbin:/sbin:/usr/bin"), _driver()
    if getcap is None or driver is None:
        return False
    said = subprocess.run([getcap, str(driver)], capture_output=True, text=True, check=False)
    return "cap_sys_nice" in said.stdout


def _driver() -> Path | None:
    path = paths.programs_folder() / "limber-driver"
    return path if path.exists() else None


def _real_time() -> Iterator[Finding]:
    setcap = f"sudo setcap cap_sys_nice,cap_ipc_lock+ep {paths.programs_folder()}/limber-driver"
    if _has_capabilities() or _limit(resource.RLIMIT_RTPRIO) >= WANTED_PRIORITY:
        yield Finding("ok", "real time", "SCHED_FIFO may be used")
    else:
        text = "SCHED_FIFO is not permitted: cycles will start late under load"
        yield Finding("warn", "real time", text, f"{setcap}, or rtprio 80 in limits.d")
    locked = _limit(resource.RLIMIT_MEMLOCK)
    if _has_capabilities() or locked > 256 << 20:
        yield Finding("ok", "locked memory", "memory may be locked")
    else:
        text = f"only {locked / 1024:.0f} KiB may be locked: a page fault can make a cycle late"
        yield Finding("warn", "locked memory", text, f"{setcap}, or memlock unlimited in limits.d")
    flavour = Path("/sys/kernel/realtime")
    kernel = (
        "PREEMPT_RT" if flavour.exists() else "not PREEMPT_RT (good enough for a simulated arm)"
    )
    yield Finding("ok", "kernel", f"{platform.release()}, {kernel}")


def _can() -> Iterator[Finding]:
    try:
        socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW).close()
    except OSError:
        text = "this kernel has none: simulated arms work (virtual: buses), real ones do not"
        yield Finding("warn", "SocketCAN", text, "sudo modprobe can_raw vcan, or another kernel")
        return
    yield Finding("ok", "SocketCAN", "the kernel has it")
    interfaces = [path.parent for path in Path("/sys/class/net").glob("*/type")]
    interfaces = [path for path in interfaces if (path / "type").read_text().strip() == "280"]
    if not interfaces:
        yield Finding("ok", "CAN interface", "none here: fine for a simulated arm")
    for interface in interfaces:
        yield _can_interface(interface)


def _can_interface(interface: Path) -> Finding:
    name = interface.name
    queue = int((interface / "tx_queue_len").read_text())
    up = int((interface / "flags").read_text(), 16) & 1
    if not up:
        return Finding("warn", name, "is down", f"sudo ip link set {name} up")
    if queue < WANTED_TXQUEUE:
        cure = f"sudo ip link set {name} txqueuelen 128"
        return Finding("warn", name, f"queue of {queue} frames: a burst is refused", cure)
    return Finding("ok", name, f"up, queue of {queue} frames")


def _programs() -> Iterator[Finding]:
    folder = paths.programs_folder()
    missing = [f"limber-{name}" for name in PROGRAMS if not (folder / f"limber-{name}").exists()]
    if missing:
        yield Finding("fail", "programs", f"not built: {', '.join(missing)}", "run ./limber")
    else:
        yield Finding("ok", "programs", f"all {len(PROGRAMS)} in {folder}")
    versions = [f"{name} {metadata.version(name)}" for name in ("limber", "lcm", "numpy")]
    yield Finding("ok", "versions", ", ".join([f"Python {platform.python_version()}", *versions]))


def _disk() -> Iterator[Finding]:
    free = shutil.disk_usage(paths.ROOT).free
    text = f"{free / 1e9:.1f} GB free"
    if free < SMALL_DISK_BYTES:
        yield Finding("warn", "disk", f"{text}: a minute of log takes 0.2 GB", "make room")
    else:
        yield Finding("ok", "disk", text)


CHECKS: tuple[Callable[[], Iterator[Finding]], ...] = (
    _multicast,
    _receive_buffer,
    _real_time,
    _can,
    _programs,
    _disk,
)


def examine() -> list[Finding]:
    return [finding for check in CHECKS for finding in check()]
