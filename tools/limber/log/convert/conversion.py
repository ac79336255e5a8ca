"""`limber log convert`: reads a log piece by piece and hands each to the writer of a format."""

import importlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import Progress

from limber.errors import InputError
from limber.log import episodes, events
from limber.log.convert.windows import Writer, joint_names, windows
from limber.log.cut import copy_events
from limber.log.reader import Log, log_file
from limber.log.results import complete_or_nothing, require_new
from limber.output import write_again


@dataclass(frozen=True)
class Format:
    """`module`.`writer` writes it; it is a file that ends in `suffix`, or a folder."""

    suffix: str
    module: str
    writer: str
    folder: bool = False
    text: bool = True  # messages with text, too
    episodes: bool = False  # made of the log's episodes


FORMATS = {
    "csv": Format("_csv", "csv_files", "CsvFiles", folder=True),
    "parquet": Format("_parquet", "parquet_files", "ParquetFiles", folder=True),
    "mcap": Format(".mcap", "mcap_file", "McapFile"),
    "rerun": Format(".rrd", "rerun_file", "RerunFile", text=False),
    "npz": Format(".npz", "npz_file", "NpzFile", text=False),
    "lerobot": Format("_lerobot", "lerobot_dataset", "LeRobotDataset", True, False, episodes=True),
    "lcm": Format(".lcmlog", "", ""),
}
EPISODE_CHANNELS = (episodes.CHANNEL, episodes.KEPT)


def convert(
    path: Path,
    to: str | None,
    out: Path | None,
    wanted: Sequence[str],
    names: events.Names,
    console: Console,
    run: int | None = None,
) -> None:
    """`run`: the only one to convert; None: all. `names`: of joints and laws; the joints' as the
    log tells them come first.
    """
    kind = _format(to, out)
    source = log_file(path)
    target = out or source.with_name(base_name(source) + FORMATS[kind].suffix)
    writer_class = _writer_class(kind)
    require_new(target)
    whole = Log(source)
    log = whole if run is None else whole.of_run(run)
    channels = log.chosen(wanted)
    joints, several = joint_names(log, names.joints)
    told: list[str] = []
    options: dict[str, Any] = {}
    if FORMATS[kind].episodes:
        marked = episodes.of_part(episodes.episodes(whole), log)
        used, told = episodes.usable(marked)
        options["marked"] = used if marked else None
        channels = [name for name in channels if name not in EPISODE_CHANNELS]
    with complete_or_nothing(target) as part:
        if writer_class is None:
            copy_events(log, part, target.suffix == ".zst", channels)
        else:
            writer = writer_class(part, joints, **options)
            told += _write(log, kind, channels, writer, names, console)
    if several:
        told.append(f"several arms in this log: joints have the names of the first, {joints}")
    for line in filter(None, [log.damage(), *told]):
        console.print(line, style="yellow", markup=False, soft_wrap=True)
    console.print(f"wrote {target} ({_size(target) / 1e6:.1f} MB)", soft_wrap=True)
    if kind == "mcap":
        _write_layout(target, joints, console)


def base_name(log: Path) -> str:
    """Without the endings that limber's logs have."""
    return log.name.removesuffix(".zst").removesuffix(".lcmlog")


def _format(to: str | None, out: Path | None) -> str:
    if to is not None:
        if to not in FORMATS:
            raise InputError(f"--to {to}: there are {', '.join(FORMATS)}")
        if out is not None and FORMATS[to].folder and out.suffix:
            raise InputError(f"--out {out}: --to {to} writes a folder, one file a channel")
        return to
    if out is None:
        raise InputError(f"--to is missing: one of {', '.join(FORMATS)}")
    if not out.suffix:
        return "csv"
    if out.name.endswith(".lcmlog.zst"):
        return "lcm"
    for name, known in FORMATS.items():
        if out.suffix == known.suffix:
            return name
    endings = ", ".join(known.suffix for known in FORMATS.values() if not known.folder)
    raise InputError(f"--out {out}: end it in {endings}, or give --to {', '.join(FORMATS)}")


def _writer_class(kind: str) -> Callable[..., Writer] | None:
    """None: events are copied as they are."""
    chosen = FORMATS[kind]
    if not chosen.module:
        return None
    module = importlib.import_module(f"limber.log.convert.{chosen.module}")
    writer: Callable[..., Writer] = getattr(module, chosen.writer)
    return writer


def _write(
    log: Log,
    kind: str,
    channels: list[str],
    writer: Writer,
    names: events.Names,
    console: Console,
) -> list[str]:
    """Returns what the user has to know of it."""
    told = []
    story: list[events.Event] = []
    try:
        if log.runs > 1:
            raise InputError(f"{log.runs} runs, one after the other; --run N converts one")
        story = events.events(log, names)
    except InputError as error:
        told.append(f"the story of the run is left out: {error}")
    writer.begin(story, arm_time_zero_us(log))
    known = [name for name in channels if log.type_of(name) is not None]
    copied = dict.fromkeys(channels, 0)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task(f"to {kind}", total=log.size_bytes)
        for position, window in windows(log, known):
            taken = [b for b in window if b.fixed or FORMATS[kind].text]
            writer.write(taken)
            for batch in taken:
                copied[batch.channel] += len(batch.stamps_us)
            progress.update(task, completed=position)
    writer.close()
    return told + [
        _left_out(log, name, len(log.channels[name]) - count, kind)
        for name, count in copied.items()
        if count < len(log.channels[name])
    ]


def _left_out(log: Log, channel: str, count: int, kind: str) -> str:
    if log.type_of(channel) is None:
        why = "not a channel of limber's"
    elif count == log.undecodable(channel):
        why = f"not {log.type_of(channel)}, or of another version of limber"
    elif not FORMATS[kind].text:
        why = f"--to {kind} has no place for text; csv, parquet and mcap do"
    else:
        why = "cannot be read"
    return f"{channel}: {count} messages left out: {why}"


def arm_time_zero_us(log: Log) -> int:
    """The time stamp at which arm time was zero, by the first message that has both."""
    for channel in ("JOINT_STATE", "CONTROLLER_STATUS", "SIM_TRUTH", "DRIVER_STATUS"):
        if channel in log.channels:
            stamps_us, found = log.records(channel, 0, 1)
            if len(found):
                return int(stamps_us[0]) - int(found["time_ns"][0]) // 1000
    return 0


def _size(path: Path) -> int:
    files = path.iterdir() if path.is_dir() else [path]
    return sum(file.stat().st_size for file in files)


def _write_layout(target: Path, joints: tuple[str, ...], console: Console) -> None:
    from limber.log.convert import foxglove_layout

    path = target.with_suffix(".foxglove.json")
    write_again(path, foxglove_layout.text(joints))
    console.print(f"wrote {path}: panels for Foxglove, Layouts > Import from file", soft_wrap=True)
