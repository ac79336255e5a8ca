"""Panels for Foxglove that fit a converted log: Layouts > Import from file."""

import json
from typing import Any

from limber.log.convert.foxglove_messages import BASE_FRAME, POSES
from limber.log.convert.mcap_file import LOG_TOPIC

TERMS = ("stiffness", "damping", "null", "gravity", "coriolis", "friction", "sent")
ERROR = ("x_m", "y_m", "z_m", "rx_rad", "ry_rad", "rz_rad")
FORCE = ("fx_N", "fy_N", "fz_N")
ENERGIES = ("kinetic_energy_J", "spring_energy_J", "tank_energy_J")


def text(joints: tuple[str, ...]) -> str:
    """The layout file; `joints`: the names in the log."""
    state = "/JOINT_STATE.joints"
    status = "/CONTROLLER_STATUS"
    first = joints[0] if joints else "joint1"
    left = [
        ("Plot!q", _plot("joint position, rad", {j: f"{state}.{j}.q_rad" for j in joints})),
        ("Plot!tau", _plot("joint torque, N m", {j: f"{state}.{j}.tau_Nm" for j in joints})),
        (
            "Plot!terms",
            _plot(
                f"torque of {first}, term by term, N m",
                {term: f"{status}.joints.{first}.tau_{term}_Nm" for term in TERMS},
            ),
        ),
    ]
    right = [
        ("3D!tip", _scene()),
        ("Plot!e", _plot("tip minus goal", {name: f"{status}.e.{name}" for name in ERROR})),
        (
            "Plot!F",
            _plot("contact force, estimated, N", {n: f"{status}.F_ext.{n}" for n in FORCE}),
        ),
        ("Plot!energy", _plot("energy, J", {n: f"{status}.{n}" for n in ENERGIES})),
    ]
    below = [
        ("StateTransitions!modes", _states(f"{status}.mode", "/JOINT_STATE.drive_state")),
        ("RosOut!events", {"topicToRender": LOG_TOPIC, "minLogLevel": 1, "searchTerms": []}),
    ]
    panels = {"first": _stack(left), "second": _stack(right), "direction": "row"}
    layout = {"first": panels, "second": _stack(below, "row"), "direction": "column"}
    return json.dumps(
        {
            "configById": dict([*left, *right, *below]),
            "globalVariables": {},
            "userNodes": {},
            "playbackConfig": {"speed": 1},
            "layout": layout | {"splitPercentage": 75},
        },
        indent=1,
    )


def paths(layout: str) -> list[str]:
    """What the panels read: paths of numbers, and topics."""
    found = []
    for panel in json.loads(layout)["configById"].values():
        found += [path["value"] for path in panel.get("paths", [])]
        found += panel.get("topics", {})
        found += [panel["topicToRender"]] if "topicToRender" in panel else []
    return found


def _plot(title: str, lines: dict[str, str]) -> dict[str, Any]:
    entries = [_path(path) | {"label": label} for label, path in lines.items()]
    return {"foxglovePanelTitle": title, "paths": entries, "xAxisVal": "timestamp"} | {
        "isSynced": True,
        "showLegend": True,
        "legendDisplay": "floating",
        "showXAxisLabels": True,
        "showYAxisLabels": True,
    }


def _states(*lines: str) -> dict[str, Any]:
    entries = [_path(path) for path in lines]
    return {"foxglovePanelTitle": "mode and drives", "isSynced": True, "paths": entries}


def _path(value: str) -> dict[str, Any]:
    return {"value": value, "enabled": True, "timestampMethod": "receiveTime"}


def _scene() -> dict[str, Any]:
    shown = {topic: {"visible": True, "axisScale": 0.2} for topic in POSES}
    return {"foxglovePanelTitle": "tip and goal", "followTf": BASE_FRAME, "topics": shown}


def _stack(panels: list[tuple[str, Any]], direction: str = "column") -> Any:
    """Panels of the same size; a layout is a tree of pairs."""
    if len(panels) == 1:
        return panels[0][0]
    rest = _stack(panels[1:], direction)
    share = {"splitPercentage": 100 / len(panels)}
    return {"first": panels[0][0], "second": rest, "direction": direction} | share
