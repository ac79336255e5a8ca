"""`limber plot`: a log as PNG files and as one interactive page."""

from pathlib import Path

from rich.console import Console

from limber.errors import InputError
from limber.log.reader import Log
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
    return f"{log.path.parent.name}/{log.path.name}" if log.path.parent.name else log.path.name


def _joint_names(folder: Path) -> list[str]:
    """From the copy of the robot that a run leaves beside its log; none beside other logs."""
    if not (folder / "robot.yaml").is_file():
        return []
    return load_robot(str(folder.resolve())).joint_names
