"""`limber export service`: systemd units that run driver and controller of a real arm.

Each has an account of its own: the driver's alone may open CAN sockets, and the arm plane is a Unix
socket that only the two accounts' group can reach. A process that dies is started again into INIT:
the arm moves only after somebody has acknowledged.

The texts are those that the Debian package installs (assets/service): units for any robot. What
this robot needs beside them is a drop-in for each.
"""

from pathlib import Path

from rich.console import Console

from limber.errors import OK, InputError
from limber.model.robot import load_robot
from limber.output import write_again
from limber.paths import ASSETS, FROM_DEBIAN, output_folder, program, robot_folder
from limber.run.buses import addresses, real

ROLES = ("driver", "controller")
DROP_IN = """\
# Written by `limber export service {robot}`.
[Unit]
{unit_section}
[Service]
ExecStart=
ExecStart={command}
"""
COPY_SHARED = """\
  cp {out}/*.service {out}/*.target /etc/systemd/system/
  cp {out}/limber.sysusers.conf /etc/sysusers.d/limber.conf && systemd-sysusers
  cp {out}/limber.tmpfiles.conf /etc/tmpfiles.d/limber.conf && systemd-tmpfiles --create
  cp {out}/limber.sysctl.conf /etc/sysctl.d/60-limber.conf && sysctl --system
"""
STEPS = """
[bold]Look at the files, then as root:[/]
{copy_shared}  cp -r {out}/*.d /etc/systemd/system/
  systemctl daemon-reload && systemctl enable --now limber@{robot}.target
The journal has what they report: journalctl -fu 'limber-*@{robot}'
"""


def escaped(interface: str) -> str:
    """As in the name of its unit: systemd-escape(1)."""
    return interface.replace("-", "\\x2d")


def shared_files() -> dict[str, str]:
    """File name -> contents, the same for all robots. Limits of users are none of a service's."""
    files = sorted(path for path in (ASSETS / "service").iterdir() if "limits" not in path.name)
    return {path.name: path.read_text(encoding="utf-8") for path in files}


def drop_ins(robot: str, overrides: tuple[str, ...] = ()) -> dict[str, str]:
    """File name -> contents. All buses must be SocketCAN interfaces: a service drives motors."""
    folder = robot_folder(robot)
    config = load_robot(str(folder))
    chosen = addresses(config, overrides)
    simulated = [name for name, address in chosen.items() if address not in real(chosen)]
    if simulated:
        raise InputError(
            f"bus '{simulated[0]}' of {robot} is simulated ({chosen[simulated[0]]}), and a service "
            f"drives motors: --bus {simulated[0]}=socketcan:INTERFACE, or `can:` in robot.yaml"
        )
    serial = [address for address in chosen.values() if not address.startswith("socketcan:")]
    if serial:
        raise InputError(
            f"{serial[0]}: a service opens CAN sockets alone; bring the adapter up as an "
            "interface (slcand), or run limber run --no-sim as yourself"
        )
    interfaces = [address.removeprefix("socketcan:") for address in real(chosen)]
    devices = " ".join(f"sys-subsystem-net-devices-{escaped(each)}.device" for each in interfaces)
    words = "".join(f" --bus {override}" for override in overrides)
    after = {"driver": f"Wants={devices}\nAfter={devices}\n", "controller": ""}
    more = {"driver": words, "controller": ""}
    return {
        f"limber-{role}@{config.name}.service.d/robot.conf": DROP_IN.format(
            robot=config.name,
            unit_section=after[role],
            command=f'"{program(f"limber-{role}")}" --robot "{folder}" --realtime{more[role]}',
        )
        for role in ROLES
    }


def write(robot: str, overrides: tuple[str, ...], out: Path, console: Console) -> int:
    """The units, and what to do with them."""
    name = load_robot(robot).name
    contents = drop_ins(robot, overrides)
    if not FROM_DEBIAN:  # whose package has them
        contents |= shared_files()
    for file, text in contents.items():
        path = out / file
        output_folder(path.parent)
        write_again(path, text)
        console.print(f"wrote {path}", soft_wrap=True)
    copy_shared = "" if FROM_DEBIAN else COPY_SHARED.format(out=out)
    console.print(STEPS.format(out=out, robot=name, copy_shared=copy_shared), soft_wrap=True)
    return OK
