"""`limber plot`: a log, or two beside each other, as PNG files and as one interactive page."""

from pathlib import Path

from rich.console import Console

from limber.errors import InputError
from limber.log.reader import log_file
from limber.log.results import written_whole
from limber.paths import output_folder
from limber.plot import charts, page
from limber.plot.drawing import drawing, leave_out_constant


def plot(
    path: Path,
    topics: list[str],
    out: Path | None,
    console: Console,
    compare: Path | None = None,
    run: int | None = None,
) -> list[Path]:
    """Returns the files it wrote: TOPIC.png for each topic, and plot.html with all of them. `run`:
    of a log that holds several; None: the last.
    """
    for topic in topics:
        if topic not in charts.TOPICS:
            raise InputError(f"--what {topic}: there are {', '.join(charts.TOPICS)}")
    drawn = drawing(path, topics, run)
    if drawn.run:
        console.print(f"{path}: {drawn.run} is drawn; --run chooses another", soft_wrap=True)
    other = drawing(compare, topics) if compare else None
    leave_out_constant(drawn, other)
    folder = output_folder(out or log_file(path).parent)
    prefix = "compare-" if other else ""
    from limber.plot import png  # matplotlib takes a second to load

    written = [folder / f"{prefix}{topic}.png" for topic in drawn.topics]
    for topic, file in zip(drawn.topics, written, strict=True):
        with written_whole(file) as part:
            png.save(topic, drawn, part, other)
    written.append(folder / f"{prefix}plot.html")
    with written_whole(written[-1]) as part:
        page.save(drawn, part, other)
    for file in written:
        console.print(f"wrote {file}", soft_wrap=True)
    return written
