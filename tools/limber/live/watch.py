"""`limber watch`: a live view of the arm in a terminal."""

import time
from contextlib import closing

import numpy as np
from rich.columns import Columns
from rich.console import Console, Group
from rich.live import Live
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from limber import messages, problems, tables
from limber.errors import LimberError
from limber.live.hand import hand_text
from limber.live.receiver import Receiver
from limber.model.robot import JointInfo, load_robot
from limber.model.rotations import rotation_error
from limber.problems import Problem, sentence

PERIODIC = (
    "JOINT_STATE",
    "JOINT_TORQUE",
    "CONTROLLER_STATUS",
    "DRIVER_STATUS",
    "SIM_TRUTH",
    "ROBOT_INFO",
    "HAND_STATE",
)
OF_HAND = ("HAND_STATE",)  # shown once there is one
BAR_WIDTH = 16
STATE_WIDTH, TIP_WIDTH = 36, 43  # beside each other in 80 columns, with all words whole
JOINTS_WIDTH = 66  # of the joints' table, without their names
CAUSED = ("FAULT", "ESTOP", "SOFT_STOP")  # modes in which what caused them still holds
GOOD, WARN, BAD = "green", "yellow", "bold red"


def _settings(status: np.void) -> dict[str, str]:
    """Settings of the law that differ from the default."""
    settings = {}
    if status["contact"]:
        sources = messages.constants("compliance_gains_t", "CONTACT_")
        settings["contact"] = sources[int(status["contact"])].lower().replace("_", " ")
    terms = messages.constants("compliance_gains_t", "PERIOD_")
    held = {terms[i]: int(cycles) for i, cycles in enumerate(status["term_period_cycles"])}
    periods = [f"{term} {cycles}" for term, cycles in held.items() if cycles > 1]
    if periods:
        settings["periods"] = ", ".join(periods) + " cycles"
    return settings


def _mode(status: np.void) -> str:
    return messages.constants("controller_status_t", "MODE_").get(int(status["mode"]), "unknown")


def _sentences(problem: Problem, where: str) -> Text:
    text = Text(problem.code + (f" ({where})" if where else ""), style=BAD)
    return text.append(
        f" {sentence(problem.what)} To do: {problem.remedy}.", style="not bold default"
    )


class View:
    """Draws the receiver's state. Names and limits of the joints are those of the arm that the
    stack names (ROBOT_INFO).
    """

    def __init__(self, receiver: Receiver, laws: list[str]) -> None:
        self.receiver = receiver
        self.laws = laws
        self.robot = ""
        self.joints: list[JointInfo] = []

    def _find_robot(self) -> None:
        """Reads its files when the stack names another than before."""
        data = self.receiver.channels["ROBOT_INFO"].data
        if not data:
            return
        info = messages.decode("robot_info_t", data)
        named = f"{info.robot}, {'simulated' if info.simulated else 'REAL MOTORS'}"
        if named == self.robot:
            return
        self.robot = named
        try:
            self.joints = load_robot(info.folder or info.robot).joints
        except LimberError:  # on another machine: names alone
            self.joints = [JointInfo(name, -np.inf, np.inf, 0.0) for name in info.joints]

    def render(self, width: int = 120) -> Group:
        """`width`: columns there are."""
        self._find_robot()
        state = self.receiver.newest("JOINT_STATE")
        status = self.receiver.newest("CONTROLLER_STATUS")
        title = Text(self.robot or "arm")
        panels = [Panel(self._state(state, status), title=title, padding=0, width=STATE_WIDTH)]
        panels.append(Panel(self._tip(status), title="tip", padding=0, width=TIP_WIDTH))
        hand = self.receiver.newest("HAND_STATE")
        return Group(
            Columns(panels),
            *([] if hand is None else [Text(hand_text(hand), style=WARN if hand["warm"] else "")]),
            *self._problems(state, status),
            self._joints(state, width)
            if state is not None
            else Text("no JOINT_STATE yet", style=WARN),
            self._buses(self.receiver.newest("DRIVER_STATUS")),
            self._channels(),
        )

    def _problems(self, state: np.void | None, status: np.void | None) -> list[Text]:
        """What is wrong now, each with a sentence and what to do."""
        found = []
        if state is not None and not self._drives_on(state):
            found.append(self._at(problems.problem("driver", state["fault"]), state["fault_joint"]))
        if state is not None:
            found += [(problems.problem("sensor", state["sensor_state"]), "")]
            found += [(problems.problem("stop", state["emergency_stop"]), "")]
            found += self._joint_problems(state)
        driver = self.receiver.newest("DRIVER_STATUS")
        if driver is not None:
            states = driver["bus_state"][: int(driver["num_buses"])]
            found += [(problems.problem("bus", s), f"bus {b + 1}") for b, s in enumerate(states)]
        if status is not None and _mode(status) in CAUSED:
            reason = problems.problem("controller", status["reason"])
            found.append(self._at(reason, status["reason_joint"]))
        return [_sentences(problem, where) for problem, where in found if problem is not None]

    def _joint_problems(self, state: np.void) -> list[tuple[Problem | None, str]]:
        """One of each kind, with the joints that have it."""
        found: dict[str, tuple[Problem, list[str]]] = {}
        for i in range(messages.driven_joints(state)):
            for problem in problems.problems_of_bits("joint", state["joint_flags"][i]):
                found.setdefault(problem.code, (problem, []))[1].append(self._joint_name(i))
        return [(problem, ", ".join(names)) for problem, names in found.values()]

    def _at(self, problem: Problem | None, joint: int) -> tuple[Problem | None, str]:
        return problem, self._joint_name(int(joint)) if joint >= 0 else ""

    @staticmethod
    def _drives_on(state: np.void) -> bool:
        """A fault of before is over."""
        kinds = messages.message_class("joint_state_t")
        return bool(state["drive_state"] == kinds.DRIVE_ON)

    def _stale(self, channel: str) -> bool:
        last = self.receiver.channels[channel]
        timeout_s = messages.channels()[channel].timeout_s
        return last.count == 0 or time.monotonic() - last.last_s > max(timeout_s, 0.2)

    def _state(self, state: np.void | None, status: np.void | None) -> Table:
        table = Table.grid(padding=(0, 1))
        if status is None or self._stale("CONTROLLER_STATUS"):
            table.add_row("mode", Text("STALE: no controller", style=BAD))
        if status is not None:
            mode = _mode(status)
            law = int(status["law"])
            limits = [
                p.code.removeprefix("limit.")
                for p in problems.problems_of_bits("limit", status["limits"])
            ]
            reason = problems.problem("controller", status["reason"])
            table.add_row("mode", Text(mode, style=GOOD if mode in ("HOLD", "ACTIVE") else WARN))
            table.add_row("law", self.laws[law] if 0 <= law < len(self.laws) else f"number {law}")
            if reason is not None and mode in CAUSED:
                table.add_row("because", Text(reason.code.removeprefix("controller."), style=BAD))
            if status["stream"]:
                stream = messages.constants("controller_status_t", "STREAM_")
                margin = f"{1e3 * float(status['stream_margin_s']):+.0f} ms"
                counts = ", ".join(
                    f"{count} {name}"
                    for name in ("late", "stale", "refused", "starved")
                    if (count := int(status[f"stream_{name}"]))
                )
                table.add_row("stream", f"{stream[int(status['stream'])].lower()}, {margin}")
                table.add_row("", Text(counts or "none lost", style=WARN if counts else ""))
            table.add_row("limits", Text(", ".join(limits) or "none", style=WARN if limits else ""))
            for name, setting in _settings(status).items():
                table.add_row(name, setting)
        if state is None or self._stale("JOINT_STATE"):
            table.add_row("drives", Text("STALE: no driver", style=BAD))
        if state is not None:
            drive = messages.constants("joint_state_t", "DRIVE_")[int(state["drive_state"])]
            over = self._drives_on(state)
            fault = None if over else problems.problem("driver", state["fault"])
            table.add_row("drives", Text(drive, style=GOOD if drive == "ON" else WARN))
            shown = "none" if fault is None else fault.code
            table.add_row("fault", Text(shown, style="" if fault is None else BAD))
            table.add_row("arm time", f"{float(state['time_ns']) * 1e-9:.1f} s")
        return table

    def _tip(self, status: np.void | None) -> Table:
        table = Table.grid(padding=(0, 1))
        if status is None:
            return table
        away = (status["p_BT"] - status["p_BD"]) * 1e3
        turned = rotation_error(status["quat_BT"][None], status["quat_BD"][None])[0]
        table.add_row("", "x", "y", "z")
        table.add_row("position", *(f"{v:+.4f}" for v in status["p_BT"]), "m")
        table.add_row("away", *(f"{v:+.2f}" for v in away), "mm")
        table.add_row("turned", *(f"{v:+.2f}" for v in np.degrees(turned)), "°")
        table.add_row("force", *(f"{v:+.1f}" for v in status["F_law"][:3]), "N")
        K_x = np.diag(status["K_x"])
        table.add_row("stiffness", *(f"{k:.0f}" for k in K_x[:3]), "N/m")
        table.add_row("", *(f"{k:.1f}" for k in K_x[3:]), "N m/rad")
        if status["contact"]:
            table.add_row("contact", *(f"{v:+.1f}" for v in status["F_ext"][:3]), "N")
            table.add_row("", *(f"{v:+.2f}" for v in status["F_ext"][3:]), "N m")
        energies = {"spring": "spring", "tank": "tank", "passive": "passivity"}
        for label, energy in energies.items():
            table.add_row(label, f"{float(status[f'{energy}_energy_J']):+.3f}", "", "", "J")
        return table

    def _joint_name(self, index: int) -> str:
        return messages.joint_name([joint.name for joint in self.joints], index)

    def _joints(self, state: np.void, width: int) -> Table:
        """Without the bars where names are too long for them."""
        numbers = (">speed", ">torque", ">applied", ">°C", ">age")
        names = [self._joint_name(i) for i in range(messages.driven_joints(state))]
        bars = JOINTS_WIDTH + max(map(len, names), default=0) <= width
        place = ("<",) if bars else ()
        table = tables.table("~joint", ">position", *place, *numbers, padding=(0, 1))
        for i, name in enumerate(names):
            q = float(state["q"][i])
            age = int(state["age_cycles"][i])
            table.add_row(
                Text(name),
                f"{q:+.3f}",
                *((self._bar(i, q),) if bars else ()),
                f"{float(state['v'][i]):+.3f}",
                f"{float(state['tau'][i]):+.2f}",
                f"{float(state['tau_applied'][i]):+.2f}",
                f"{float(state['temperature_degC'][i]):.0f}",
                Text(f"{age}", style=BAD if age > 1 else ""),
            )
        return table

    def _bar(self, index: int, q: float) -> Text:
        if index >= len(self.joints):
            return Text("")
        low, high = self.joints[index].low, self.joints[index].high
        if not (np.isfinite(low) and np.isfinite(high)):
            return Text("")
        place = round((q - low) / (high - low) * (BAR_WIDTH - 1))
        near = not 1 <= place <= BAR_WIDTH - 2
        place = min(max(place, 0), BAR_WIDTH - 1)
        return Text("─" * place + "●" + "─" * (BAR_WIDTH - 1 - place), style=WARN if near else GOOD)

    def _buses(self, status: np.void | None) -> Table:
        of_bus = (">load", ">predicted", ">refused", ">errors", ">foreign")
        of_joints = (">late", ">lost", ">invalid")
        table = tables.table("<bus", "<state", *of_bus, *of_joints, padding=(0, 1))
        if status is None:
            return table
        replies = [int(np.sum(status[f"replies_{how}"])) for how in ("late", "lost", "invalid")]
        for b in range(int(status["num_buses"])):
            problem = problems.problem("bus", status["bus_state"][b])
            counts = [int(status[key][b]) for key in ("send_refused", "error_frames")]
            foreign = int(status["frames_foreign"][b])
            table.add_row(
                f"{b + 1}",
                Text("good") if problem is None else Text(problem.code, style=BAD),
                f"{float(status['bus_load_counted'][b]):.0%}",
                f"{float(status['bus_load_predicted'][b]):.0%}",
                *(Text(f"{n}", style=WARN if n else "") for n in (*counts, foreign)),
                *(Text(f"{n}", style=WARN if n else "") for n in (replies if b == 0 else ())),
            )
        return table

    def _channels(self) -> Table:
        table = tables.table("<channel", ">Hz", ">age", ">lost", "<", padding=(0, 2))
        for name, state in self.receiver.channels.items():
            if name in OF_HAND and not state.count:
                continue
            age = f"{time.monotonic() - state.last_s:.2f} s" if state.count else "-"
            stale = Text("STALE" if self._stale(name) else "", style=BAD)
            lost = Text(str(state.lost), style=WARN if state.lost else "")
            table.add_row(name, f"{state.rate_hz():.0f}", age, lost, stale)
        return table


def watch(laws: list[str], once: bool, console: Console, rate_hz: float = 10.0) -> None:
    """Draws until Ctrl-C; with `once`, one picture after one second."""
    with closing(Receiver(*PERIODIC)) as receiver:
        view = View(receiver, laws)
        if once:
            time.sleep(1.0)
            console.print(view.render(console.width))
            return
        with Live(
            view.render(console.width), console=console, auto_refresh=False, screen=True
        ) as live:
            while True:
                time.sleep(1.0 / rate_hz)
                live.update(view.render(console.width), refresh=True)
