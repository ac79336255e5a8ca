"""What passes through the spring: the motor's torque outwards, the link's motion inwards."""

import numpy as np

from limber_lecture import testbench as bench
from limber_lecture.context import Comparison, Context
from limber_lecture.elastic import ElasticArm, one_joint
from limber_lecture.pictures import BLUE, GREEN, MARKS, ORANGE, Axes, name_axes
from limber_lecture.ringdown import DELAY_S
from limber_lecture.testbench import FAST_KGM2, FREE, B, M, sensed, sprung
from limber_lecture.truth import motion, status, time_s
from limber_lecture.variants import friction

from .tracking import K_S, START_S

OMEGA_N = np.sqrt(K_S / B)
D_MOTOR = 2.0  # N m s/rad, low-pass
K_T = 4.0
D_LOOP = 0.2  # N m s/rad at the motor: what the sampled loop needs
RATE_HZ = 4000.0
SLOW_S, FAST_S = 1.256, 0.010  # periods of the pushes, about 5 and 600 rad/s


def low_pass(omega: float | np.ndarray) -> float | np.ndarray:
    """|τ/τ_m| with the link held."""
    return 1 / np.abs(1 - (omega / OMEGA_N) ** 2 + 1j * D_MOTOR * omega / K_S)


def stiffness(omega: float | np.ndarray, d: float = 0.0, T: float = 0.0) -> float | np.ndarray:
    """|τ/q| with τ_d = 0; d: at the motor, T: the loop's torque is held so long."""
    motor = 1j * omega * d - B * omega**2
    return np.abs(K_S * motor / ((1 + K_T * np.exp(-0.5j * omega * T)) * K_S + motor))


def amplitude(t: np.ndarray, y: np.ndarray, omega: float) -> float:
    """Of y's part at omega, beside an offset and a drift."""
    basis = np.column_stack([np.ones_like(t), t - t[0], np.cos(omega * t), np.sin(omega * t)])
    return float(np.hypot(*np.linalg.lstsq(basis, y, rcond=None)[0][2:]))


def response(arm: ElasticArm, loop_gain: float, into: int, omega: float) -> np.ndarray:
    """(q, θ) for a unit sine of the motor's torque (into 0) or of a push (1), by solving
    (jω - A) x = E u with the torque loop τ_m = -K_T τ in A.
    """
    A, E = arm.matrices()
    A = A - loop_gain * K_S * E[:, :1] @ np.array([[-1.0, 1.0, 0.0, 0.0]])
    return np.linalg.solve(1j * omega * np.eye(4) - A, E[:, into])[:2]


def low_pass_ideal(omega: float) -> float:
    arm = one_joint(FAST_KGM2, B, K_S, 0.0, motor_damping=D_MOTOR)
    q, theta = response(arm, 0.0, 0, omega)
    return float(np.abs(K_S * (theta - q)))


def low_pass_bus(context: Context, omega: float) -> tuple[float, float]:
    """The goal goes to and fro as fast as that; frequency, and sensed over applied torque.

    The joint's gain puts the motor's resonance there.
    """
    half_ms = round(np.pi / omega * 1e3)
    omega = np.pi / (half_ms * 1e-3)
    changes = {**sprung(K_S, 0.0, friction=friction(viscous=D_MOTOR)), "urdf": "held.urdf"}
    K = float(B * omega**2 - K_S)
    back = K * DELAY_S  # what delay takes
    gains = bench.spring_damper(K, back, position_feedback="motor")
    count = round(4.0 / (half_ms * 1e-3))
    moves = [{"joints_rad": [0.05 * (-1) ** i], "duration_s": 0.1} for i in range(count)]
    goals = [{"at_s": START_S + i * half_ms * 1e-3, "goal": move} for i, move in enumerate(moves)]
    end = START_S + count * half_ms * 1e-3
    name = f"low_pass_{omega:.0f}"
    log = bench.on_bus(context, name, gains, goals, end, changes=changes)
    status(log, START_S + 1.5, end)
    seen, rows = sensed(log, START_S + 1.5, end), motion(log, START_S + 1.5, end)
    applied = amplitude(time_s(rows), rows["tau_motor"][:, 0], omega)
    return omega, amplitude(seen["t"], seen["tau"], omega) / applied


def stiffness_ideal(omega: float) -> float:
    """Ratio of the spring's torque to the link's angle when the link is pushed to and fro."""
    q, theta = response(one_joint(M, B, K_S, 0.0), K_T, 1, omega)
    return float(np.abs(K_S * (theta - q) / q))


def stiffness_bus(context: Context, period_s: float, torque: float) -> tuple[float, float]:
    """Pushes to and fro; frequency, and sensed torque over the link's angle."""
    omega, half = 2 * np.pi / period_s, period_s / 2
    loop = {"inertia_ratio": 1 + K_T, "rate_hz": RATE_HZ}
    changes = sprung(K_S, 0.0, friction=friction(viscous=D_LOOP), torque_loop=loop)
    # a quarter of a period first: the link then does not drift away
    pushes = [bench.push(-torque, START_S, half / 2)]
    count = 2 * round(max(4.0, 6 * period_s) / period_s)
    begin = START_S + half / 2
    pushes += [bench.push(torque * (-1) ** i, begin + i * half, half) for i in range(count)]
    end = begin + count * half
    log = bench.on_bus(context, f"push_{omega:.0f}", FREE, pushes, end, changes=changes)
    whole = np.floor((end - begin - 1.0) / period_s) * period_s
    seen = sensed(log, end - whole, end)
    tau, q = (amplitude(seen["t"], seen[name], omega) for name in ("tau", "q"))
    return omega, tau / q


Point = tuple[str, float, float]  # ideal or bus, rad/s, measured


def checks(context: Context) -> tuple[list[Comparison], list[Point]]:
    """And the stiffnesses that were measured, for the picture."""
    made, points = [], []
    for factor in (2, 4):
        omega = factor * OMEGA_N
        ways = [("ideal", omega, low_pass_ideal(omega)), ("bus", *low_pass_bus(context, omega))]
        for where, at, share in ways:
            name = f"motor torque that reaches the link at {at / OMEGA_N:.2f} times its frequency"
            made.append(Comparison(f"{name}, {where}", low_pass(at), share, "", 0.01))
    for period, torque, omega in ((SLOW_S, 5.0, 5.0), (FAST_S, 50.0, 600.0)):
        at, seen = stiffness_bus(context, period, torque)
        points += [("ideal", omega, stiffness_ideal(omega)), ("bus", at, seen)]
        formula = float(stiffness(at, D_LOOP, 1 / RATE_HZ))
        for (where, at, got), asked, more in zip(
            points[-2:],
            (float(stiffness(omega)), formula),
            ("", ", with the motor's damping and the loop's hold"),
            strict=True,
        ):
            name = f"torque for the link's angle at {at:.3g} rad/s, torque loop, {where}{more}"
            made.append(Comparison(name, asked, got, "N m/rad", 0.01))
    return made, points


def draw(points: list[Point], ax: Axes) -> None:
    omega = np.geomspace(2, 2000, 400)
    ax.loglog(omega, stiffness(omega), color=BLUE, label="torque loop, gain 4")
    ax.loglog(omega, B / (1 + K_T) * omega**2, ":", color=GREEN, label="B ω²/5: the loop's")
    ax.axhline(K_S, ls="--", color=ORANGE, label="the spring's, whatever the loop does")
    for where, style in MARKS.items():
        found = np.array([point[1:] for point in points if point[0] == where])
        ax.loglog(*found.T, **style, color=BLUE, label=where)
    ax.set_ylim(0.05, 3e4)
    ax.set_title("What a hand feels that moves the link to and fro")
    name_axes(ax, "frequency (rad/s)", "torque over angle (N m/rad)", "best")
