"""`limber monitor`: serves the page of a running stack, or of a log, until Ctrl-C."""

import signal
import time
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

from rich.console import Console

from limber.errors import InputError
from limber.log.reader import Log, log_file
from limber.messages import MONITOR_CLIENT
from limber.model.robot import Robot, load_robot, robot_beside
from limber.model.scenario import load_scenario, scenario_beside
from limber.monitor import server
from limber.monitor.control import ControlPanel
from limber.monitor.episodes import EpisodePanel
from limber.monitor.goal_handle import GoalHandle
from limber.monitor.guard import Guard
from limber.monitor.hand_panel import HandPanel
from limber.monitor.laws import list_laws
from limber.monitor.live_feed import LiveFeed
from limber.monitor.log_feed import LogFeed
from limber.monitor.page import DRAW_S, HISTORY_S, Page
from limber.monitor.playback import PlaybackPanel
from limber.monitor.push_tool import PushTool
from limber.monitor.requests import Requests
from limber.monitor.running_arm import RunningArm, follow_arms
from limber.monitor.stop import StopButtons
from limber.monitor.typed import TypedFields
from limber.monitor.view_options import add_view_options
from limber.monitor.walls import wall_changes

PORT = 8080


def live(
    named: str | None, port: int, control: bool, scenario: Path | None, console: Console
) -> None:
    """`named`: the arm, else the one that runs. `control`: the page may move it; else it shows,
    and can stop.
    """
    walls = wall_changes(load_scenario(scenario)) if scenario else []

    def show(robot: Robot, feed: LiveFeed, running: RunningArm) -> bool:
        nonlocal port
        served = _serve(port, console)
        port = served.get_port()  # where the browser connects again by itself
        console.print(f"{served.url}  [dim]{_kind(control)}; Ctrl-C ends it[/]", soft_wrap=True)
        page = Page(served, robot, list_laws(robot.folder), feed, walls, Guard(console))
        return _show(page, feed, running, control, follow=named is None)

    follow_arms(named, console, show)


def _show(page: Page, feed: LiveFeed, running: RunningArm, control: bool, follow: bool) -> bool:
    """Until Ctrl-C: False, or, with `follow`, until another arm runs: True."""
    served, robot, laws, gui = page.server, page.robot, page.laws, page.server.gui
    requests = Requests(feed, MONITOR_CLIENT + served.get_port())
    StopButtons(gui, requests)
    typed = TypedFields(served.link, page.tell_typed)
    parts: list[Callable[[], None]] = []
    goal = None
    page.control = control
    tabs = gui.add_tab_group()
    if control:
        with tabs.add_tab("control"):
            panel = ControlPanel(gui, robot, laws, requests, feed, typed, page.pending)
            parts.append(panel.draw)
            served.link.on("press", panel.pressed)
        with tabs.add_tab("push"):
            push = PushTool(gui, page.scene.arm, feed, requests, served.link, typed)
            parts.append(push.draw)
        if robot.hand is not None:
            with tabs.add_tab("hand"):
                parts.append(HandPanel(gui, robot.hand, requests, feed, typed).draw)
        size_m = 0.35 * page.scene.figure.reach_m
        goal = GoalHandle(served.scene, size_m, feed, laws, requests)
    with tabs.add_tab("episodes"):
        episodes = EpisodePanel(gui, feed)
    with tabs.add_tab("view"):
        add_view_options(gui, page.scene)
    page.add_charts()

    def draw() -> bool:
        batch = page.draw()
        page.guard(episodes.draw, batch)
        outcomes = requests.collect(batch)
        page.tell(outcomes)
        page.tell_stop(requests.stops, requests.stop_state)
        with served.turn:
            for part in parts:
                page.guard(part)
            if goal is not None:
                page.guard(goal.draw, outcomes)
        running.note(batch)
        page.other_arm = running.other_than(robot)
        return not (follow and page.other_arm)

    with closing(requests):
        return _loop(draw, served)


def _kind(control: bool) -> str:
    if control:
        return "the page can move the arm"
    return "read only, but for STOP; --control lets it move the arm"


def play(path: Path, robot_name: str | None, port: int, console: Console) -> None:
    """Of a recorded run. The robot and the walls are those beside the log, if they are there."""
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    file = log_file(path)
    folder = file.parent
    robot = robot_beside(folder) if robot_name is None else load_robot(robot_name)
    if robot is None:
        raise InputError(f"{folder} holds no robot.yaml: name the arm with --robot")
    feed = LogFeed(Log(file), HISTORY_S)
    laws = list_laws(robot.folder)
    scenario = scenario_beside(folder)
    served = _serve(port, console)
    walls = wall_changes(scenario) if scenario else []
    page = Page(served, robot, laws, feed, walls, Guard(console))
    typed = TypedFields(served.link, page.tell_typed)
    panel = PlaybackPanel(served, feed, Log(file), robot.joint_names, laws, typed)
    with served.gui.add_folder("view", expand_by_default=False):
        add_view_options(served.gui, page.scene)
    page.add_charts()
    console.print(f"{served.url}  [dim]{file}; Ctrl-C ends it[/]", soft_wrap=True)
    last = time.monotonic()

    def draw() -> bool:
        nonlocal last
        now = time.monotonic()
        with served.turn:
            feed.advance(now - last)
            page.guard(panel.draw)
        last = now
        page.draw()
        return True

    _loop(draw, served)


def _serve(port: int, console: Console) -> server.Server:
    served = server.start(port)
    if served.get_port() != port:
        console.print(f"port {port} is taken; using {served.get_port()}", style="yellow")
    return served


def _loop(draw: Callable[[], bool], served: server.Server) -> bool:
    """Thirty pictures a second, fewer on a busy machine, while `draw` returns True; returns True
    when it no longer does, False after Ctrl-C or `kill`, which are its good end.
    """
    try:
        begun = time.monotonic()
        while draw():
            time.sleep(max(DRAW_S - (time.monotonic() - begun), 0.2 * DRAW_S))
            begun = time.monotonic()
        return True
    except KeyboardInterrupt:
        return False
    finally:
        served.close()
