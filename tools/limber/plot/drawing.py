"""All that is drawn of one run."""

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from limber.errors import InputError
from limber.log.events import Names
from limber.log.reader import Log, time_s
from limber.log.rows import active
from limber.model.gains_table import acts_at_joints, law_names
from limber.model.robot import Robot, robot_beside
from limber.plot import charts
from limber.plot.chart import Chart, went_back
from limber.plot.marks import Mark, Span, marks, spans
from limber.plot.stick_figure import View, arm_points

FRAMES = 800  # of the moving stick figure


@dataclass(frozen=True)
class Figure:
    """A stick figure that moves: base, joints and tip in a plane that is upright, m."""

    t_s: np.ndarray  # frames
    places: np.ndarray  # frames x points x 2
    low: np.ndarray  # 2, the window
    high: np.ndarray


@dataclass
class Drawing:
    """`title`: the run, and of which arm, law and stiffness it is. `results`: of its summary.json,
    empty beside a log that has none. `figure`: None without the robot beside the log.
    """

    title: str
    topics: dict[str, list[Chart]]
    marks: list[Mark] = field(default_factory=list)
    spans: list[Span] = field(default_factory=list)
    results: list[dict[str, Any]] = field(default_factory=list)
    figure: Figure | None = None
    run: str = ""  # which, of a log that holds several
    constant: dict[str, list[str]] = field(default_factory=dict)  # by topic: what is not drawn

    @property
    def verdict(self) -> str:
        judged = [result for result in self.results if result.get("pass") is not None]
        failed = [result["name"] for result in judged if not result["pass"]]
        if failed:
            return f"failed: {', '.join(failed)} ({len(failed)} of {len(judged)} checks)"
        return f"all {len(judged)} checks passed" if judged else ""


def drawing(path: Path, topics: list[str], run: int | None = None) -> Drawing:
    """`topics`: empty for all that the log has something of. `run`: None for the last."""
    log, several = Log(path).one_run(run)
    folder = log.path.parent
    robot = _robot(folder)
    names = Names(robot.joint_names if robot else [], law_names())
    built = {topic: charts.build(log, topic, names.joints) for topic in topics or charts.TOPICS}
    if topics or not any(built.values()):
        _refuse_empty(built, log)
    built = {topic: drawn for topic, drawn in built.items() if drawn}
    begin_s = charts.begin_s(log)
    marked = marks(log, names, begin_s)
    figure = _figure(log, robot, begin_s) if robot else None
    title = " · ".join(filter(None, [_title(log), several]))
    results = [] if several else _results(folder)
    return Drawing(title, built, marked, spans(log, marked), results, figure, several)


def leave_out_constant(drawn: Drawing, other: Drawing | None) -> None:
    """Charts in which nothing changes become words in `constant`, unless a topic has no other."""
    for topic, shown in drawn.topics.items():
        beside = {chart.title: chart for chart in (other.topics.get(topic, []) if other else [])}
        still = [
            chart
            for chart in shown
            if chart.constant() and (chart.title not in beside or beside[chart.title].constant())
        ]
        if len(still) < len(shown):
            drawn.topics[topic] = [
                chart for chart in shown if not any(chart is one for one in still)
            ]
            drawn.constant[topic] = [chart.constant() for chart in still]


def _figure(log: Log, robot: Robot, begin_s: float) -> Figure | None:
    state = log.read("JOINT_STATE")
    t = time_s(state)
    rows = np.flatnonzero((t >= begin_s) & ~went_back(t))
    if len(rows) < 2:
        return None
    rows = rows[np.unique(np.linspace(0, len(rows) - 1, FRAMES).astype(int))]
    n = len(robot.joints)
    points = np.array([arm_points(robot, q) for q in state["q"][rows, :n]])
    up = np.array([0.0, 0, 1]) if not robot.gravity.any() else -robot.gravity
    view = View.of(points.reshape(-1, 3), up)
    places = view.project(points)
    return Figure(t[rows], places, view.low, view.high)


def _refuse_empty(built: dict[str, list[Chart]], log: Log) -> None:
    for topic, drawn in built.items():
        if not drawn:
            source = ", ".join(charts.SOURCES[topic])
            there = ", ".join(sorted(log.channels))
            raise InputError(f"--what {topic} is drawn from {source}; {log.path} holds {there}")


def _title(log: Log) -> str:
    name = f"{log.path.parent.name}/{log.path.name}" if log.path.parent.name else log.path.name
    return " · ".join([name, *_subject(log)])


def _subject(log: Log) -> list[str]:
    infos, status = log.decode("ROBOT_INFO"), log.read("CONTROLLER_STATUS")
    facts = [info.robot for info in infos[:1]]
    under_law = status[active(status)]
    if not len(under_law):
        return facts
    last, laws = under_law[-1], law_names()
    law = laws[int(last["law"])] if 0 <= last["law"] < len(laws) else ""
    K_x, K_q = np.diag(last["K_x"]), last["K_q"][: int(last["num_joints"])]
    parts = ((K_x[:3], "N/m"), (K_x[3:], "N m/rad"))
    for part, unit in ((K_q, "N m/rad"),) if acts_at_joints(law) else parts:
        if part.any():
            values = part[:1] if np.ptp(part) == 0 else part
            facts.append("/".join(f"{value:.4g}" for value in values) + f" {unit}")
    return [*facts[:1], law, *facts[1:]] if law else facts


def _robot(folder: Path) -> Robot | None:
    """The copy that a run leaves beside its log; none beside other logs."""
    return robot_beside(folder)


def _results(folder: Path) -> list[dict[str, Any]]:
    try:
        return list(json.loads((folder / "summary.json").read_text(encoding="utf-8"))["results"])
    except (OSError, ValueError, KeyError, TypeError):
        return []
