"""Commands for a stack that is running."""

from pathlib import Path
from typing import Annotated

import typer

from limber.cli import groups
from limber.cli.options import become, console
from limber.errors import InputError

app = typer.Typer()


@app.command(epilog="Example: limber send 'gains: {K_x_translation_N_per_m: 200, ramp_s: 0.5}'")
def send(
    entries: Annotated[
        list[str] | None,
        typer.Argument(
            help="Such as 'mode: active' or 'hand: {width_m: 0.03, force_N: 20}'; recover: from a "
            "fault to a running law (acknowledge, hold, active), waiting for each."
        ),
    ] = None,
    robot: Annotated[
        str | None, typer.Option(help="Name or folder; default: the arm of the running stack.")
    ] = None,
    release: Annotated[
        bool,
        typer.Option(
            "--release",
            help="With recover, on a real arm: release the drives where one is in error; the arm "
            "sinks.",
        ),
    ] = False,
) -> None:
    """Send requests (mode, gains, goal, hand, push, ...) to a running stack."""
    from limber.live.known_words import check_entries
    from limber.live.network import require_multicast

    require_multicast()
    if release and entries != ["recover"]:
        raise InputError("--release belongs to: limber send --release recover")
    if "recover" in (entries or []):
        if entries != ["recover"]:
            raise InputError("limber send recover: stands alone, without other requests")
        from limber.live.recover import recover

        console.print(repr(recover(robot, release or None)), markup=False)
        return
    check_entries(entries or [])
    become("limber-send", *(["--robot", robot] if robot else []), *(entries or []))


@app.command(epilog="Example: limber watch --once")
def watch(
    once: Annotated[bool, typer.Option("--once", help="Print one picture and exit.")] = False,
) -> None:
    """Show mode, joints, tip, stiffness, faults and channel rates of the running arm live."""
    from limber.live import watch as module
    from limber.live.network import require_multicast
    from limber.model.gains_table import law_names

    require_multicast()
    module.watch(law_names(), once, console)


@groups.log.command(epilog="Example: limber log spy")
def spy() -> None:
    """Start lcm-spy with limber's message types: every channel, its rate, its fields."""
    from limber.live import spy as module

    module.start()


@groups.log.command(epilog="Example: limber log record --out push.lcmlog.zst --duration 10")
def record(
    out: Annotated[
        Path, typer.Option("--out", help="Log file to write; compressed if it ends in .zst.")
    ],
    duration: Annotated[
        float, typer.Option(min=0.0, max=1e6, help="Seconds; 0: until Ctrl-C.")
    ] = 0.0,
    episodes: Annotated[
        bool, typer.Option("--episodes", help="Mark episodes by key: start, success, failure.")
    ] = False,
    task: Annotated[str, typer.Option(help="What is done in them, such as 'pick a block'.")] = "",
) -> None:
    """Record all messages without loss, until Ctrl-C."""
    from limber.paths import output_folder

    output_folder(out.parent)
    if task and not episodes:
        raise InputError("--task belongs to --episodes")
    if episodes:
        from limber.live import episode_keys
        from limber.log.episodes import show

        episode_keys.record(out, duration, task, console)
        show(out, console)
        return
    become("limber-record", "--out", str(out), "--duration", str(duration))
