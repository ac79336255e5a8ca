"""The terminal during a run: a progress bar and, on request, the live view."""

from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager

from rich.console import Console, Group
from rich.live import Live
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from limber.live.listener import Listener
from limber.live.watch import PERIODIC, View, law_names
from limber.model.scenario import Scenario


@contextmanager
def display(scenario: Scenario, console: Console, live_view: bool) -> Iterator[Callable[[], None]]:
    """Gives the function that refreshes it. Outside a terminal it is one line."""
    if not console.is_terminal:
        console.print(f"{scenario.name}: {scenario.duration_s:g} s")
        yield lambda: None
        return
    progress = Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.completed:.1f} of {task.total:.1f} s"),
        TimeElapsedColumn(),
        console=console,
    )
    task = progress.add_task(scenario.name, total=scenario.duration_s)
    with closing(Listener(*(PERIODIC if live_view else ("DRIVER_STATUS",)))) as listener:
        views = [View(listener, scenario.robot.joints, law_names())] if live_view else []

        def picture() -> Group:
            return Group(*(view.render() for view in views), progress)

        with Live(picture(), console=console, auto_refresh=False, transient=live_view) as live:

            def update() -> None:
                status = listener.newest("DRIVER_STATUS")
                if status is not None:
                    progress.update(task, completed=float(status["time_ns"]) * 1e-9)
                live.update(picture(), refresh=True)

            yield update
