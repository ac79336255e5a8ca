"""The terminal during a run: a progress bar and, on request, the live view."""

from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from rich.console import Console, Group
from rich.live import Live
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from limber.live.receiver import Receiver
from limber.model.scenario import Scenario
from limber.run.demo_view import SHOWN, DemoView


@contextmanager
def display(
    scenario: Scenario, log: Path, console: Console, live_view: bool
) -> Iterator[Callable[[], None]]:
    """Gives the function that refreshes it. Outside a terminal it is one line. `log`: the file
    that grows meanwhile, if there is one.
    """
    if not console.is_terminal:
        console.print(f"{scenario.name}: {scenario.duration_s:g} s")
        yield lambda: None
        return
    progress = Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.completed:.1f} of {task.total:.1f} s"),
        TextColumn("{task.fields[size]}", style="dim"),
        TimeElapsedColumn(),
        console=console,
    )
    task = progress.add_task(scenario.name, total=scenario.duration_s, size="")
    with closing(Receiver("DRIVER_STATUS", *(SHOWN if live_view else ()))) as receiver:
        views = [DemoView(receiver, scenario)] if live_view else []

        def picture() -> Group:
            return Group(*(view.render() for view in views), progress)

        with Live(picture(), console=console, auto_refresh=False, transient=live_view) as live:

            def update() -> None:
                status = receiver.newest("DRIVER_STATUS")
                if status is not None:
                    progress.update(task, completed=float(status["time_ns"]) * 1e-9)
                if log.is_file():
                    progress.update(task, size=f"log {log.stat().st_size / 1e6:.0f} MB")
                live.update(picture(), refresh=True)

            yield update
