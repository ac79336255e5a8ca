"""What all environments have in common: an arm on a lab, its actions and observations."""

from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces

from limber.arrays import Floats
from limber.errors import InputError, RunError
from limber.gym.actions import Actions, Where
from limber.lab import Lab, RefusedByLabError
from limber.live.values import number
from limber.messages import constants, message_class
from limber.model.robot import Robot, load_robot

Observation = dict[str, np.ndarray]
READY_S = 10.0
SETTLED_S = 0.3  # after the arm is active
CONTACT = {"stiffness_N_per_m": 2e4, "damping_Ns_per_m": 50.0}  # of workpieces
FRICTIONS = ("friction", "link_friction")
BEYOND_END_RAD = 0.5  # an end stop is soft
_FAR_M, _FAST, _LARGE = 10.0, 100.0, 1000.0


class ArmEnv(gymnasium.Env):
    """A compliant arm that gets a goal every 1/`control_hz` seconds of arm time.

    Goals and impedance: limber.gym.actions. A goal is a target of a stream (docs/policies.md) with
    the control period as delay, so that the arm's goal is smooth; `frame_skip` cycles are a step.

    Observations, float32, SI: `agent_pos`, `qvel`, `tau` (joints), `contact` (estimated wrench of
    the world at the tip, base axes), `tip` (position, quaternion w, x, y, z), all as the controller
    has them; `environment_state`: the task's. Info: `success`, `limits` that acted, `energy_J`
    (kinetic, of the law's spring, work of the motors), `refused` (why the goal was not taken; the
    last one stays), `fault`, with which an episode terminates.

    reset() draws, by its seed alone, the start pose (`start_spread_rad` round home, for prismatic
    joints in m), `friction_scale` times robot.yaml's and `payload_kg` at the tip, of which the
    controller is not told. `integrator`, `step_s`: a scenario's. Equal seeds and actions give equal
    bytes.
    """

    metadata: dict[str, Any] = {"render_modes": []}  # noqa: RUF012  Gymnasium's

    def __init__(
        self,
        robot: str = "openarm",
        control_mode: str = "pd_ee_target_delta_pose",
        impedance_mode: str = "fixed",
        control_hz: float = 20.0,
        *,
        stiffness_range: tuple[float, float] = (0.2, 2.0),
        step_m: float = 0.02,
        step_rad: float = 0.1,
        step_joint: float = 0.05,
        start_spread_rad: float = 0.05,
        friction_scale: tuple[float, float] = (1.0, 1.0),
        payload_kg: tuple[float, float] = (0.0, 0.0),
        integrator: str = "reference",
        step_s: float = 5e-4,
        render_mode: str | None = None,
    ) -> None:
        if render_mode is not None:
            raise InputError("render_mode: None alone; limber monitor shows recorded runs")
        self.render_mode = None
        self.robot: Robot = load_robot(robot)
        number("control_hz", control_hz, 1.0, self.robot.rate_hz)
        self.frame_skip = round(self.robot.rate_hz / control_hz)
        self._period_s = self.frame_skip / self.robot.rate_hz
        steps = (step_m, step_rad, step_joint)
        self.actions = Actions(self.robot, control_mode, impedance_mode, stiffness_range, steps)
        self._spread = number("start_spread_rad", start_spread_rad, 0.0, 1.0)
        self._friction_scale = _range("friction_scale", friction_scale, 10.0)
        self._payload_kg = _range("payload_kg", payload_kg, 100.0)
        self._integrator, self._step_s = integrator, step_s
        self.lab: Lab | None = None
        self._words = {
            prefix: constants(type_name, f"{prefix}_")
            for type_name, prefix in (
                ("joint_state_t", "FAULT"),
                ("controller_status_t", "MODE"),
                ("controller_status_t", "REASON"),
                ("controller_status_t", "LIMIT"),
            )
        }
        self.action_space = spaces.Box(
            self.actions.low.astype(np.float32), self.actions.high.astype(np.float32)
        )
        self._boxes = self._boxes_of()
        self.observation_space = spaces.Dict({**self._boxes})

    # --- a task's ---------------------------------------------------------------------------------

    task_size = 0  # of environment_state, each within ±10

    def start_task(self, at: Where) -> None:
        """Draws the task, by np_random, with the arm active and at rest."""
        raise NotImplementedError

    def task_state(self) -> Floats:
        raise NotImplementedError

    def judge(self, at: Where) -> tuple[float, bool]:
        """Reward of the step, and whether the task is done."""
        raise NotImplementedError

    # --- Gymnasium's ------------------------------------------------------------------------------

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        super().reset(seed=seed)
        self.close()
        self.lab = Lab(self._scenario())
        self._make_ready()
        self._read()
        self._goal = self._at()
        self._impedance: Floats = np.empty(0)  # robot.yaml's, until an action names one
        self.start_task(self._goal)
        return self._observation(), self._info(refused="", success=False)

    def step(self, action: np.ndarray) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        given = np.asarray(action, float)
        if given.shape != self.actions.low.shape or not np.isfinite(given).all():
            raise InputError(f"action: expected {len(self.actions.low)} finite numbers")
        refused = self._act(given)
        self.open_lab().step(self.frame_skip)
        self._read()
        reward, success = self.judge(self._at())
        info = self._info(refused, success)
        terminated = success or bool(info["fault"])
        return self._observation(), float(reward), terminated, False, info

    def close(self) -> None:
        if self.lab is not None:
            self.lab.close()
            self.lab = None

    # --- the arm ----------------------------------------------------------------------------------

    def open_lab(self) -> Lab:
        if self.lab is None:
            raise RunError("the environment is closed: reset() opens it")
        return self.lab

    def place(self, kind: str, **fields: Any) -> None:
        """Puts a workpiece_t into the world; RefusedByLabError if its values are out of range."""
        message = message_class("workpiece_t")()
        message.kind = getattr(message, f"KIND_{kind}")
        for field, value in {**CONTACT, **fields}.items():
            setattr(message, field, np.asarray(value, float).tolist())
        self.open_lab().send(message)

    def _act(self, action: Floats) -> str:
        """Sends goal and impedance; why one of them was refused, or nothing."""
        lab = self.open_lab()
        goal = self.actions.goal(action, self._at(), self._goal)
        impedance = self.actions.impedance(action)
        try:
            if not np.array_equal(impedance, self._impedance):
                lab.send(self.actions.gains(impedance, self._period_s))
                self._impedance = impedance
            lab.send(self.actions.target(goal, self._period_s))
        except RefusedByLabError as error:
            return str(error)
        self._goal = goal
        return ""

    def _read(self) -> None:
        lab = self.open_lab()
        self._state = lab.message("JOINT_STATE")
        self._status = lab.message("CONTROLLER_STATUS")
        self._truth = lab.message("SIM_TRUTH")

    def _at(self) -> Where:
        n = len(self.robot.joints)
        return Where(self._state["q"][:n], self._status["p_BT"], self._status["quat_BT"])

    def _make_ready(self) -> None:
        lab = self.open_lab()
        for _ in range(round(READY_S / 0.05)):
            lab.step(round(0.05 * self.robot.rate_hz))
            if self._words["MODE"][int(lab.message("CONTROLLER_STATUS")["mode"])] == "ACTIVE":
                lab.step(round(SETTLED_S * self.robot.rate_hz))
                return
        raise RunError("the simulated arm has not become active")

    def _scenario(self) -> dict[str, Any]:
        draw = self.np_random.uniform
        start = self.robot.home + draw(-self._spread, self._spread, len(self.robot.joints))
        friction = draw(*self._friction_scale)
        payload_kg = draw(*self._payload_kg)
        timeline: list[dict[str, Any]] = [
            {"at_s": 0.0, "mode": "hold"},
            {"at_s": 0.0, "mode": "active"},
            {
                "at_s": 0.0,
                "gains": {"law": self.actions.law, "contact": "joint_torque", "ramp_s": 0.1},
            },
        ]
        if payload_kg >= 1e-3:
            timeline.append({"at_s": 0.0, "payload": {"mass_kg": float(payload_kg)}})
        scenario: dict[str, Any] = {
            "robot": str(self.robot.folder),
            "integrator": self._integrator,
            "step_s": self._step_s,
            "start_q": np.clip(start, *self.actions.ends).tolist(),
            "timeline": timeline,
        }
        if friction != 1.0:
            scenario["plant_overrides"] = {"joints": self._frictions(friction)}
        return scenario

    def _frictions(self, scale: float) -> dict[str, Any]:
        """Of plant_overrides."""

        def scaled(friction: dict[str, float]) -> dict[str, float]:
            return {key: scale * value for key, value in friction.items() if "_Nm" in key}

        return {
            joint["name"]: {key: scaled(joint[key]) for key in FRICTIONS if joint.get(key)}
            for joint in self.robot.resolved["joints"]
        }

    def _boxes_of(self) -> dict[str, spaces.Box]:
        n = len(self.robot.joints)
        low, high = (np.clip(end, -_FAST, _FAST) for end in self.actions.ends)
        low, high = low - BEYOND_END_RAD, high + BEYOND_END_RAD
        boxes: dict[str, spaces.Box] = {}
        boxes["agent_pos"] = spaces.Box(low.astype(np.float32), high.astype(np.float32))
        for key, most, size in (
            ("qvel", _FAST, n),
            ("tau", _LARGE, n),
            ("contact", _LARGE, 6),
            ("tip", _FAR_M, 7),
            ("environment_state", _FAR_M, self.task_size),
        ):
            boxes[key] = spaces.Box(-most, most, (size,))
        return boxes

    def _observation(self) -> Observation:
        n = len(self.robot.joints)
        values = {
            "agent_pos": self._state["q"][:n],
            "qvel": self._state["v"][:n],
            "tau": self._state["tau"][:n],
            "contact": self._status["F_ext"],
            "tip": np.concatenate([self._status["p_BT"], self._status["quat_BT"]]),
            "environment_state": self.task_state(),
        }
        return {
            key: np.clip(values[key], box.low, box.high).astype(np.float32)
            for key, box in self._boxes.items()
        }

    def _info(self, refused: str, success: bool) -> dict[str, Any]:
        limits = int(self._status["limits"])
        return {
            "success": success,
            "limits": [word for bit, word in self._words["LIMIT"].items() if limits & bit],
            "energy_J": {
                "kinetic": float(self._status["kinetic_energy_J"]),
                "spring": float(self._status["spring_energy_J"]),
                "motors": float(self._truth["work_motor_J"]),
            },
            "refused": refused,
            "fault": self._fault(),
        }

    def _fault(self) -> str:
        """Of the drives, else of the controller, in the words of lcmtypes; empty while active."""
        fault = self._words["FAULT"][int(self._state["fault"])]
        if fault not in ("NONE", "REQUESTED"):  # REQUESTED: by the controller, which has the cause
            return fault
        mode = self._words["MODE"][int(self._status["mode"])]
        if mode == "ACTIVE":
            return ""
        reason = self._words["REASON"][int(self._status["reason"])]
        return mode if reason == "NONE" else reason


def _range(key: str, given: tuple[float, float], largest: float) -> tuple[float, float]:
    low, high = (number(key, value, 0.0, largest) for value in given)
    if low > high:
        raise InputError(f"{key}: {given}: the lower end comes first")
    return low, high
