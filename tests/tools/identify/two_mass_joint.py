"""A pendulum on an elastic joint, simulated here and by nothing else, as logs of its motion.

B theta'' = kappa u - K (theta - q) - D (theta' - q') - F(theta'),
M q'' = K (theta - q) + D (theta' - q') - m g l sin q - F_l(q')

F: bristle friction with breakaway. Sensors count in steps and are noisy. rigid: theta = q.
"""

from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from made_logs import records, write_log

from limber import messages

STEP_S = 1.0 / 5000.0
RATE_HZ = 1000
LOST_EVERY = 700
GRAVITY = 9.81
MASS, LEVER = 6.0, 0.25  # kg, m; the pendulum hangs along -y at q = 0
INERTIA = 0.9  # about the axis
GEAR, CONSTANT = 100.0, 0.05  # of the motor as its drive believes it; N m/A at the rotor
BRISTLE = 1e-3  # rad; coarse, so that explicit steps are short enough


@dataclass(frozen=True)
class Friction:
    coulomb: float = 0.0
    static: float = 0.0
    stribeck: float = 0.1
    viscous: float = 0.0

    def sliding(self, speed: float) -> float:
        return self.coulomb + (self.static - self.coulomb) * np.exp(-((speed / self.stribeck) ** 2))


@dataclass(frozen=True)
class Truth:
    kappa: float = 1.0
    rotor: float = 0.5  # behind the gear
    stiffness: float = 3000.0
    damping: float = 40.0
    friction: Friction = Friction()
    link_friction: Friction = Friction()
    rigid: bool = False
    weight: float = 1.0  # of the pendulum, times what the URDF says
    motor_bits: int = 18
    link_bits: int = 20
    noise_Nm: float = 0.05


BELIEVED = Truth(friction=Friction(3.0, 3.0, 0.1, 2.0), stiffness=4000.0)


def write_robot(folder: Path, believed: Truth) -> Path:
    """robot.yaml and robot.urdf of what is believed."""
    com_inertia = INERTIA - MASS * LEVER**2
    (folder / "robot.urdf").write_text(f"""<robot name="bench">
  <link name="base"/>
  <link name="link"><inertial><origin xyz="0 {-LEVER} 0"/><mass value="{MASS}"/>
    <inertia ixx="{com_inertia}" iyy="0.1" izz="{com_inertia}" ixy="0" ixz="0" iyz="0"/>
  </inertial></link>
  <link name="flange"/>
  <joint name="j1" type="revolute"><parent link="base"/><child link="link"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" velocity="5" effort="100"/></joint>
  <joint name="end" type="fixed"><parent link="link"/><child link="flange"/>
    <origin xyz="0 -0.5 0"/></joint>
</robot>""")
    spring = f"spring: {{law: linear, stiffness_Nm_per_rad: {believed.stiffness}}}"
    elastic = f"{{kind: elastic, {spring}, damping_Nms_per_rad: {believed.damping}}}"
    kind = "{kind: rigid}" if believed.rigid else elastic
    viscous = believed.friction.viscous
    (folder / "robot.yaml").write_text(f"""format: limber-robot/1
name: bench
urdf: robot.urdf
base: base
tip: flange
rate_hz: {RATE_HZ}
gravity_m_per_s2: [0, {-GRAVITY}, 0]
buses:
  - {{name: arm, can: "virtual:bench", bitrate_bps: 1000000}}
motors:
  drive:
    protocol: cia402
    gear_ratio: {GEAR} # datasheet
    rotor_inertia_kgm2: {believed.rotor / GEAR**2}
    rotor_torque_constant_Nm_per_A: {CONSTANT} # datasheet
    phase_resistance_ohm: 0.2
    peak_torque_Nm: 100
    rated_torque_Nm: 100
    encoder_bits: 18
joints:
  j1:
    motor: drive
    bus: arm
    id: 1
    hold: {{kp_Nm_per_rad: 40, kd_Nms_per_rad: 5}}
    home_rad: 0
    transmission: {kind} # guessed
    friction: {{coulomb_Nm: {believed.friction.coulomb}, viscous_Nms_per_rad: {viscous}}}
gains: {{K_q_Nm_per_rad: 400, K_x_translation_N_per_m: 500, K_x_rotation_Nm_per_rad: 20,
  joint_damping_ratio: 0.7, damping_ratio: 0.7, K_null_Nm_per_rad: 0, D_null_Nms_per_rad: 1}}
watchdog: {{timeout_s: 0.02, reaction: damp}}
""")
    return folder


def tour(points: list[float], seconds: float, rest: float) -> np.ndarray:
    """Minimum-jerk moves from point to point, one row a step: angle and speed."""
    n, r = int(seconds / STEP_S), int(rest / STEP_S)
    x = (np.arange(n) + 1) / n
    s, ds = x**3 * (10 - 15 * x + 6 * x**2), 30 * x**2 * (1 - x) ** 2 / seconds
    rows = []
    for start, end in pairwise(points):
        rows.append(np.stack([start + (end - start) * s, (end - start) * ds], axis=1))
        rows.append(np.tile([end, 0.0], (r, 1)))
    return np.vstack(rows)


def there_and_back() -> np.ndarray:
    points = [0.0, 1.2, -1.2, 0.3]
    points = [*points, *points[-2::-1]]
    creep = [points[-1], points[-1] + 0.15, points[-1] - 0.15, points[-1]]
    return np.vstack([tour(points, 2.5, 0.3), tour(points, 1.0, 0.1), tour(creep, 5.0, 0.1)])


def simulate(truth: Truth, path: np.ndarray, seed: int = 1) -> dict[str, np.ndarray]:
    """What the sensors of each cycle say: theta, q, tau, command."""
    every = round(1.0 / STEP_S / RATE_HZ)
    theta = q = float(path[0, 0])
    w = v = z = zl = 0.0
    logged = np.zeros((len(path) // every, 6))
    load = MASS * GRAVITY * LEVER
    u = 0.0
    for k in range(len(logged) * every):
        if k % every == 0:
            goal, speed = path[k]
            u = 600.0 * (goal - theta) + 60.0 * (speed - w) + load * np.sin(q)
            spring = truth.stiffness * (theta - q)
            logged[k // every] = theta, q, w, v, spring, u
        f, z = _bristle(truth.friction, w, z)
        fl, zl = _bristle(truth.link_friction, v, zl)
        weight = truth.weight * load * np.sin(q)
        if truth.rigid:
            v += STEP_S * (truth.kappa * u - weight - f) / (INERTIA + truth.rotor)
            w = v
            q += STEP_S * v
            theta = q
            continue
        tau = truth.stiffness * (theta - q) + truth.damping * (w - v)
        w += STEP_S * (truth.kappa * u - tau - f) / truth.rotor
        v += STEP_S * (tau - weight - fl) / INERTIA
        theta += STEP_S * w
        q += STEP_S * v
    return _sensed(truth, logged, seed)


def _bristle(friction: Friction, speed: float, z: float) -> tuple[float, float]:
    """Bristle friction and its bristle after a step, which relaxes exactly at this speed."""
    if friction.coulomb == 0.0:
        return friction.viscous * speed, 0.0
    stiffness = friction.coulomb / BRISTLE
    most = friction.sliding(speed) / stiffness
    target = most * np.sign(speed)
    after = target + (z - target) * np.exp(-abs(speed) * STEP_S / most)
    return stiffness * after + friction.viscous * speed, after


def _sensed(truth: Truth, logged: np.ndarray, seed: int) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(seed)
    theta, q, w, v, spring, u = logged.T
    motor_step, link_step = (2 * np.pi / 2**bits for bits in (truth.motor_bits, truth.link_bits))
    counted = np.floor(theta / motor_step) * motor_step
    tau = np.round((spring + rng.normal(0, truth.noise_Nm, len(u))) / 0.02) * 0.02
    if truth.rigid:
        return {"theta": counted, "q": counted, "theta_dot": w, "v": w, "tau": u, "u": u}
    linked = np.floor(q / link_step) * link_step
    return {"theta": counted, "q": linked, "theta_dot": w, "v": v, "tau": tau, "u": u}


def write_run(folder: Path, sensed: dict[str, np.ndarray], sensors: bool) -> Path:
    flags = messages.message_class("joint_state_t")
    count = len(sensed["u"])
    time_ns = np.arange(count) * (10**9 // RATE_HZ)
    state = records(
        "joint_state_t", count, time_ns=time_ns, num_joints=1, period_ns=10**9 // RATE_HZ
    )
    state["drive_state"] = flags.DRIVE_ON
    bits = flags.JOINT_FRESH | flags.JOINT_ENABLED
    if sensors:
        bits |= flags.JOINT_LINK_ENCODER | flags.JOINT_TORQUE_SENSOR
    state["joint_flags"][:, 0] = bits
    for key in ("theta", "q", "theta_dot", "v", "tau"):
        state[key][:, 0] = sensed[key]
    state["tau_applied"][:, 0] = sensed["u"]
    lost = np.arange(LOST_EVERY, count, LOST_EVERY)  # replies: the driver repeats the last one
    state[lost] = state[lost - 1]
    state["seq"][lost], state["time_ns"][lost] = lost, time_ns[lost]
    state["joint_flags"][lost, 0] &= ~flags.JOINT_FRESH
    state["age_cycles"][lost, 0] = 1
    return write_log(folder / "run.lcmlog", {"JOINT_STATE": state})


def run(folder: Path, truth: Truth, believed: Truth, path: np.ndarray | None = None) -> Path:
    """A folder as a run leaves it: log, robot.yaml, robot.urdf."""
    folder.mkdir(parents=True, exist_ok=True)
    believed = replace(believed, rigid=truth.rigid)
    write_robot(folder, believed)
    sensed = simulate(truth, there_and_back() if path is None else path)
    write_run(folder, sensed, sensors=not truth.rigid)
    return folder
