"""`limber plot`: a log as PNG files and as one interactive page."""

from pathlib import Path

import numpy as np
from rich.console import Console

from limber import messages
from limber.errors import InputError
from limber.log.reader import Log
from limber.model.gains_table import law_names
from limber.model.robot import load_robot
from limber.paths import output_folder
from limber.plot import charts, page


def plot(path: Path, topics: list[str], out: Path | None, console: Console) -> list[Path]:
    """Returns the files it wrote: TOPIC.png for each topic, and plot.html with all of them."""
    for topic in topics:
        if topic not in charts.TOPICS:
            raise InputError(f"--what {topic}: there are {', '.join(charts.TOPICS)}")
    log = Log(path)
    folder = output_folder(out or log.path.parent)
    names = _joint_names(log.path.parent)
    built = {topic: charts.build(log, topic, names) for topic in topics or charts.TOPICS}
    if topics or not any(built.values()):
        _refuse_empty(built, log)
    built = {topic: drawn for topic, drawn in built.items() if drawn}
    title = _title(log)
    written = _save_png(built, title, folder)
    html = folder / "plot.html"
    page.save(built, title, html)
    for file in [*written, html]:
        console.print(f"wrote {file}", soft_wrap=True)
    return [*written, html]


def _refuse_empty(built: dict[str, list[charts.Chart]], log: Log) -> None:
    for topic, drawn in built.items():
        if not drawn:
            source = ", ".join(charts.SOURCES[topic])
            there = ", ".join(sorted(log.channels))
            raise InputError(f"--what {topic} is drawn from {source}; {log.path} holds {there}")


def _save_png(built: dict[str, list[charts.Chart]], title: str, folder: Path) -> list[Path]:
    from limber.plot import png  # matplotlib takes a second to load

    files = []
    for topic, topic_charts in built.items():
        file = folder / f"{topic}.png"
        png.save(topic_charts, f"{title}: {topic}", file)
        files.append(file)
    return files


def _title(log: Log) -> str:
    """The run, and of which arm, law and stiffness it is."""
    name = f"{log.path.parent.name}/{log.path.name}" if log.path.parent.name else log.path.name
    return " · ".join([name, *_subject(log)])


def _subject(log: Log) -> list[str]:
    infos, status = log.decode("ROBOT_INFO"), log.read("CONTROLLER_STATUS")
    facts = [info.robot for info in infos[:1]]
    active = status[status["mode"] == messages.message_class("controller_status_t").MODE_ACTIVE]
    if not len(active):
        return facts
    last, names = active[-1], law_names()
    if 0 <= last["law"] < len(names):
        facts.append(names[int(last["law"])])
    K_x = np.diag(last["K_x"])
    for part, unit in ((K_x[:3], "N/m"), (K_x[3:], "N m/rad")):
        if part.any():
            values = part[:1] if np.ptp(part) == 0 else part
            facts.append("/".join(f"{value:.4g}" for value in values) + f" {unit}")
    return facts


def _joint_names(folder: Path) -> list[str]:
    """From the copy of the robot that a run leaves beside its log; none beside other logs."""
    if not (folder / "robot.yaml").is_file():
        return []
    return load_robot(str(folder.resolve())).joint_names
