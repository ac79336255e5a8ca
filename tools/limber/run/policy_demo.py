"""`limber demo policy`: a recorded policy picks and places, and is killed in the middle."""

import numpy as np
from rich.console import Console

from limber import tables
from limber.arrays import Floats
from limber.errors import OK, OUT_OF_TOLERANCE
from limber.live import network
from limber.log.reader import Log, time_s
from limber.messages import message_class
from limber.model.scenario import Scenario, load_scenario
from limber.paths import SCENARIOS, run_folder
from limber.run import commands, runner
from limber.run.options import RunOptions

SCENARIO = SCENARIOS / "policy.yaml"
REST_M_PER_S = 1e-3
MOST_PLACED_MM = 5.0


def demo(options: RunOptions, console: Console) -> int:
    scenario = load_scenario(SCENARIO)
    if options.page:
        network.require_shared_network(options.private_network, "the ports that a browser opens")
    network.ensure_multicast(options.private_network)
    console.print(
        f"A recorded policy moves a simulated {scenario.robot.name}: 30 targets a second, late, a "
        "tenth of them lost. It takes a block, is killed on the way, and starts again."
    )
    folder = run_folder(options.out or commands.next_folder("policy"))
    finished = runner.run(scenario, folder, options, console)
    summary, _ = commands.summarize(finished, scenario)
    log = Log(finished.log)
    found = Found(log, scenario)
    table = tables.table("<", ">", title="A policy with a soft arm", padding=(0, 1, 0, 0))
    for name, value in found.rows():
        table.add_row(name, value)
    console.print(table)
    commands.show_faults(summary, finished.folder, console)
    from limber.run import policy_picture

    picture = finished.folder / "policy.png"
    policy_picture.save(found, scenario, picture)
    console.print(f"{picture}  [dim]the run in one picture[/]", soft_wrap=True)
    console.print(f"{finished.log}  [dim]all messages: limber plot {folder}[/]", soft_wrap=True)
    return OK if found.good and not summary.faults else OUT_OF_TOLERANCE


class Found:
    """What the run's log holds. Times in s of arm time, positions in m, forces in N."""

    def __init__(self, log: Log, scenario: Scenario) -> None:
        status, hand = log.read("CONTROLLER_STATUS"), log.read("HAND_STATE")
        truth = log.read("HAND_TRUTH")
        self.t, self.goal = time_s(status), status["p_BD"].astype(float)
        self.tip = status["p_BT"].astype(float)
        self.active = status["mode"] == message_class("controller_status_t").MODE_ACTIVE
        self.status = status
        self.hand_t, self.hand = time_s(hand), hand
        self.truth_t, self.block = time_s(truth), truth["p_BO"][:, 0].astype(float)
        targets = [entry for entry in scenario.timeline if "stream" in entry]
        self.sent_s = np.array([entry["at_s"] for entry in targets])
        pauses = np.diff(self.sent_s)
        self.killed_s = float(self.sent_s[np.argmax(pauses)])
        self.again_s = float(self.sent_s[np.argmax(pauses) + 1])

    @property
    def held_s(self) -> float:
        """When the controller no longer waited for the policy."""
        held = np.flatnonzero((self.t > self.killed_s) & ~self.active)
        return float(self.t[held[0]]) if len(held) else self.again_s

    @property
    def good(self) -> bool:
        return bool(self.status["stream_refused"][-1] == 0 and self.placed_mm < MOST_PLACED_MM)

    @property
    def moved(self) -> Floats:
        """Of the block, from where it lay at first."""
        way: Floats = self.block[-1] - self.block[0]
        return way

    @property
    def placed_mm(self) -> float:
        """From where the tip's last goal before it let go wanted it."""
        wanted = self.goal[self._let_go()] - self.goal[self._took()]
        return float(np.linalg.norm((self.moved - wanted)[:2]) * 1e3)

    def _took(self) -> int:
        first = self.hand_t[np.flatnonzero(self.hand["grasped"])[0]]
        return int(np.searchsorted(self.t, first))

    def _let_go(self) -> int:
        last = self.hand_t[np.flatnonzero(self.hand["grasped"])[-1]]
        return min(int(np.searchsorted(self.t, last)), len(self.t) - 1)

    def rest(self) -> tuple[float, float]:
        """Time and way of the goal from the policy's last target to rest."""
        after = (self.t > self.killed_s) & (self.t < self.held_s)
        speed = np.linalg.norm(np.gradient(self.goal[after], self.t[after], axis=0), axis=1)
        moving = np.flatnonzero(speed > REST_M_PER_S)
        end = moving[-1] if len(moving) else 0
        way = np.linalg.norm(self.goal[after][end] - self.goal[after][0])
        return float(self.t[after][end] - self.killed_s), float(way)

    def torque_step(self) -> float:
        """Greatest change of a joint's torque within a millisecond, N m."""
        tau = self.status["tau_sent"].astype(float)
        steps = np.abs(np.diff(tau, axis=0)).max(axis=1) / np.diff(self.t)
        both = self.active[1:] & self.active[:-1]
        return float(steps[both].max() * 1e-3)

    def rows(self) -> list[tuple[str, str]]:
        last, held = self.status[-1], self.hand["grasped"] != 0
        rest_s, way_m = self.rest()
        lifted_mm = (self.block[:, 2].max() - self.block[0, 2]) * 1e3
        grip_N = float(np.median(self.hand["force_N"][held])) if held.any() else 0.0
        return [
            (
                "targets taken, late, too old, refused",
                ", ".join(str(last[f"stream_{n}"]) for n in ("taken", "late", "stale", "refused")),
            ),
            ("the goal runs behind by", f"{float(last['stream_delay_s']) * 1e3:.0f} ms"),
            ("greatest step of a torque", f"{self.torque_step():.2f} N m a millisecond"),
            ("the block is held with", f"{grip_N:.1f} N"),
            ("and lifted by", f"{lifted_mm:.0f} mm"),
            ("killed: the goal is at rest after", f"{rest_s:.2f} s, {way_m * 1e3:.0f} mm on"),
            ("the arm is held after", f"{self.held_s - self.killed_s:.2f} s"),
            ("started again after", f"{self.again_s - self.killed_s:.1f} s, without a stop"),
            ("the block lies beside its place by", f"{self.placed_mm:.1f} mm"),
        ]
