"""`limber export service`: systemd units that run driver and controller of a real arm.

Each has an account of its own: the driver's alone may open CAN sockets, and the arm plane is a Unix
socket that only the two accounts' group can reach. A process that dies is started again into INIT:
the arm moves only after somebody has acknowledged.
"""

from pathlib import Path

from rich.console import Console

from limber.errors import OK, InputError
from limber.model.robot import load_robot
from limber.output import write_again
from limber.paths import output_folder, program, robot_folder
from limber.run.buses import addresses, real

RESTARTS = 3  # within RESTART_WINDOW_s, then somebody has to see to it
RESTART_WINDOW_s = 600
CONFIGURATION_WRONG = 2  # a restart would not help: see common/program.h

UNIT = """\
# Written by `limber export service {robot}`.
[Unit]
Description=limber {role} of {robot}
PartOf=limber-{robot}.target
{unit_section}StartLimitIntervalSec={window}
StartLimitBurst={restarts}

[Service]
ExecStart={command}
Environment=LIMBER_ARM_URL=unix:/run/limber-{robot}/arm
User=limber-{role}
Group=limber
Restart=on-failure
RestartSec=1
RestartPreventExitStatus={wrong}
LimitRTPRIO=80
LimitMEMLOCK=infinity
NoNewPrivileges=yes
CapabilityBoundingSet=
ProtectSystem=strict
ReadWritePaths=/run/limber-{robot}
ProtectHome=read-only
PrivateDevices=yes
RestrictAddressFamilies=AF_UNIX AF_INET AF_NETLINK{families}

[Install]
WantedBy=limber-{robot}.target
"""

TARGET = """\
# Written by `limber export service {robot}`.
[Unit]
Description=limber stack of {robot}
Wants=limber-{robot}-driver.service limber-{robot}-controller.service

[Install]
WantedBy=multi-user.target
"""

ACCOUNTS = """\
# Written by `limber export service {robot}`.
g limber - -
u limber-driver -:limber "limber driver" -
u limber-controller -:limber "limber controller" -
"""

FOLDER = """\
# Written by `limber export service {robot}`.
d /run/limber-{robot} 0770 limber-driver limber -
"""

STEPS = """
[bold]Look at the files, then as root:[/]
  cp {out}/*.service {out}/*.target /etc/systemd/system/
  cp {out}/limber.sysusers.conf /etc/sysusers.d/limber.conf && systemd-sysusers
  cp {out}/limber-{robot}.tmpfiles.conf /etc/tmpfiles.d/limber-{robot}.conf
  systemd-tmpfiles --create
  systemctl daemon-reload && systemctl enable --now limber-{robot}.target
The journal has what they report: journalctl -fu 'limber-{robot}-*'
"""


def escaped(interface: str) -> str:
    """As in the name of its unit: systemd-escape(1)."""
    return interface.replace("-", "\\x2d")


def files(robot: str, overrides: tuple[str, ...] = ()) -> dict[str, str]:
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
    name = config.name
    interfaces = [address.removeprefix("socketcan:") for address in real(chosen)]
    devices = " ".join(f"sys-subsystem-net-devices-{escaped(each)}.device" for each in interfaces)

    def unit(role: str, unit_section: str, arguments: str, families: str) -> str:
        return UNIT.format(
            robot=name,
            role=role,
            unit_section=unit_section,
            command=f'"{program(f"limber-{role}")}" --robot "{folder}" --realtime{arguments}',
            families=families,
            window=RESTART_WINDOW_s,
            restarts=RESTARTS,
            wrong=CONFIGURATION_WRONG,
        )

    words = "".join(f" --bus {override}" for override in overrides)
    return {
        f"limber-{name}-driver.service": unit(
            "driver", f"Wants={devices}\nAfter={devices}\n", words, " AF_CAN"
        ),
        f"limber-{name}-controller.service": unit("controller", "", "", ""),
        f"limber-{name}.target": TARGET.format(robot=name),
        f"limber-{name}.tmpfiles.conf": FOLDER.format(robot=name),
        "limber.sysusers.conf": ACCOUNTS.format(robot=name),
    }


def write(robot: str, overrides: tuple[str, ...], out: Path, console: Console) -> int:
    """The units, and what to do with them."""
    checked = load_robot(robot)
    contents = files(robot, overrides)
    folder = output_folder(out)
    for name, text in contents.items():
        write_again(folder / name, text)
        console.print(f"wrote {folder / name}", soft_wrap=True)
    console.print(STEPS.format(out=folder, robot=checked.name), soft_wrap=True)
    return OK
