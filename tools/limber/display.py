"""What a run shows while it runs: how far it is, and on request the live view."""

from types import TracebackType

from rich.console import Console, Group
from rich.live import Live
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from limber.listen import Listener
from limber.scenario import Scenario
from limber.watch import PERIODIC, View, law_names


class Display:
    """Use as a context, call update() now and then. Without a terminal it is one line."""

    def __init__(self, scenario: Scenario, console: Console, watch: bool) -> None:
        self._console = console
        self._listener = Listener(*(PERIODIC if watch else ("DRIVER_STATUS",)))
        self._progress = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.completed:.1f} of {task.total:.1f} s"),
            TimeElapsedColumn(),
            console=console,
        )
        self._task = self._progress.add_task(scenario.name, total=scenario.duration_s)
        self._view = None
        if watch:
            self._view = View(self._listener, scenario.robot.joints, law_names())
        self._live = Live(
            self._picture(), console=console, auto_refresh=False, transient=self._view is not None
        )

    def __enter__(self) -> "Display":
        self._listener.__enter__()
        if self._console.is_terminal:
            self._live.start()
        else:
            task = self._progress.tasks[0]
            self._console.print(f"{task.description}: {task.total:g} s", highlight=False)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._console.is_terminal:
            self._live.stop()
        self._listener.__exit__(kind, error, trace)

    def update(self) -> None:
        if not self._console.is_terminal:
            return
        status = self._listener.newest("DRIVER_STATUS")
        if status is not None:
            self._progress.update(self._task, completed=float(status["time_ns"]) * 1e-9)
        self._live.update(self._picture(), refresh=True)

    def _picture(self) -> Group:
        view = [self._view.render()] if self._view is not None else []
        return Group(*view, self._progress)
