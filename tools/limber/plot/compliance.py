"""Force over displacement: what a hand feels while it pushes, law by law."""

import numpy as np

from limber.log.reader import time_s
from limber.log.rows import active
from limber.model.gains_table import law_names
from limber.plot.chart import Chart, Messages

TITLE = "push along its direction over displacement"
AFTER_S = 0.5  # where the tip stays
POINTS = 200  # of a push
MOST = 6  # pushes
SAME = 0.02  # of two stiffnesses


def compliance_charts(log: Messages) -> list[Chart]:
    """One way a push under a law, and, dashed, the line of the stiffness in effect. The simulator
    alone knows what pushes.
    """
    status, truth = log.read("CONTROLLER_STATUS"), log.read("SIM_TRUTH")
    under_law = active(status)
    if not len(truth) or not under_law.any():
        return []
    t, at = time_s(truth), time_s(status)
    row = np.clip(np.searchsorted(at, t, side="right") - 1, 0, None)
    force = truth["F_push"][:, :3]
    pushed = (np.linalg.norm(force, axis=1) > 0) & under_law[row]
    chart = Chart(TITLE, "N", np.zeros(0), x="displacement of the tip (mm)", loop=True)
    lines: dict[str, tuple[float, float]] = {}
    ways = []
    for begin, end in _stretches(pushed)[:MOST]:
        last = np.searchsorted(t, t[end - 1] + AFTER_S)
        later = np.flatnonzero(pushed[end:last])
        last = end + later[0] if len(later) else last
        n = force[begin:end][np.argmax(np.linalg.norm(force[begin:end], axis=1))]
        n = n / np.linalg.norm(n)
        rows = np.unique(np.linspace(begin, last - 1, POINTS).astype(int))
        x_mm = (truth["p_BT"][rows] - truth["p_BT"][begin]) @ n * 1e3
        ways.append((_name(status[row[begin]], n), x_mm, force[rows] @ n))
        K = float(n @ status["K_x"][row[begin], :3, :3] @ n)
        if K > 0 and not any(abs(K - k) < SAME * K for k, _ in lines.values()):
            lines[f"{K:.4g} N/m"] = K, float(np.abs(force[begin:end] @ n).max())
    for name, (K, F) in lines.items():
        ways.append((name, np.array([0.0, F / K * 1e3]), np.array([0.0, F])))
    return [_put(chart, ways, set(lines))] if ways else []


def _stretches(pushed: np.ndarray) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.concatenate([[0], pushed.astype(int), [0]])))
    pairs = edges.reshape(-1, 2)
    return [(int(a), int(b)) for a, b in pairs if b - a > 1]


def _name(status: np.void, n: np.ndarray) -> str:
    names, law = law_names(), int(status["law"])
    axis = "xyz"[int(np.argmax(np.abs(n)))]
    return f"{names[law] if 0 <= law < len(names) else f'law {law}'}, {axis}"


def _put(chart: Chart, ways: list, dashed: set[str]) -> Chart:
    """All ways one behind the other: each series has its own stretch, and NaN elsewhere."""
    chart.t_s = np.concatenate([x for _, x, _ in ways])
    at = 0
    for name, x, y in ways:
        values = chart.series.get(name, np.full(len(chart.t_s), np.nan))
        values[at : at + len(x)] = y
        chart.series[name] = values
        at += len(x)
    chart.dashed = dashed
    return chart
