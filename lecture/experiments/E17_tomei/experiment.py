"""Position control of the motor, gravity torque of the goal: does the link come to rest there?"""

import numpy as np

from limber_lecture import testbench as bench
from limber_lecture.context import Comparison, Context, case, ideal_and_bus
from limber_lecture.pictures import BLUE, MEASURED, ORANGE, Axes, level, name_axes, plot_marks

from . import joint, seven

TITLE = "A motor PD with constant gravity torque holds an arm up if both springs in series can"
CLAIM = "A high-gain law on the motor works, though a proof of stability is difficult"
SECTION = "3.2"
PLANT = "link that weighs 20 N m, upright on a spring of 60 N m/rad: its equations (ideal), and the"
PLANT += " test bench on its bus"
FAST = False

TRIED = (15.0, 20.0, 25.0, 28.0, 35.0, 50.0, 80.0)
BESIDE, SECONDS = 0.3, 12.0  # rad from upright at the start, s until it rests
AFAR, AFAR_K_P = 3.0, 60.0
TOO_SOFT = 18.0  # N m/rad: less than the weight pulls
STIFF_LAW = 1000.0


def run(context: Context) -> list[Comparison]:
    ideal = [joint.final_error_model(K_P, BESIDE, SECONDS) for K_P in TRIED]
    bus = [joint.final_error_bus(context, K_P, BESIDE, SECONDS) for K_P in TRIED]
    path = joint.from_afar_bus(context, AFAR_K_P, AFAR)
    model = joint.path_model(AFAR_K_P, path.t, path.q_d)
    with context.picture(TITLE, columns=2, size=(13.5, 5.2)) as (left, right):
        draw_errors(ideal, bus, left)
        draw_afar(path, model, right)
    return [
        *limits(context),
        *errors(ideal, bus),
        *afar(path, model),
        *too_soft(context),
        *sufficient(context),
        *seven.checks(context),
    ]


def limits(context: Context) -> list[Comparison]:
    found = joint.critical_model(), joint.critical_bus(context, [28.5, 31.5])
    name = "smallest motor gain that holds the arm up"
    return ideal_and_bus(name, joint.CRITICAL, *found, "N m/rad", 0.01)


def errors(ideal: list[float], bus: list[float]) -> list[Comparison]:
    made = []
    for K_P, model, seen in zip(TRIED, ideal, bus, strict=True):
        wanted = joint.final_error(K_P)
        name = f"final error with K_P = {K_P:g} N m/rad"
        tolerance = (0.01, "relative") if wanted > 0 else (2e-3, "absolute")
        made += ideal_and_bus(name, wanted, model, seen, "rad", *tolerance)
    return made


def afar(path: joint.Path, model: np.ndarray) -> list[Comparison]:
    """K_P above the bound of the proof."""
    name = f"final error from {AFAR:g} rad away, K_P = {AFAR_K_P:g} above {joint.SUFFICIENT:g}"
    ends = [abs(float(q[-100:].mean()) - joint.UPRIGHT) for q in (model, path.q)]
    return ideal_and_bus(name, 0.0, *ends, "rad", 1e-3, "absolute")


def sufficient(context: Context) -> list[Comparison]:
    """K_P at which the controller finds the smallest eigenvalue at α; it takes no less."""
    gains = np.linspace(40.0, 60.0, 41)
    state = {"theta": [0.0], "thetad": [0.0], "q_d": [0.0], "K": [joint.SPRING], "KD": [0.0]}
    answers = context.eval([case("tomei", bench.ROBOT, KP=[K_P], **state) for K_P in gains])
    eigenvalues = [answer["lambda_min"] for answer in answers]
    found = float(np.interp(joint.GRAVITY, eigenvalues, gains))
    name = "motor gain that the proof asks for, by the controller"
    bound = joint.SUFFICIENT
    made = [Comparison(name, bound, found, "N m/rad", 1e-3)]
    for share, refused in ((0.99, 1), (1.01, 0)):
        name = f"refused of one request, K_P = {share * bound:g} N m/rad, bus"
        seen = joint.refused_bus(context, share * bound)
        made.append(Comparison(name, refused, seen, "", 0.0, "absolute"))
    return made


def too_soft(context: Context) -> list[Comparison]:
    """A spring below α: no gain helps."""
    wanted = joint.final_error(STIFF_LAW, TOO_SOFT)
    ideal = joint.final_error_model(STIFF_LAW, BESIDE, SECONDS, TOO_SOFT)
    bus = joint.final_error_bus(context, STIFF_LAW, BESIDE, SECONDS, TOO_SOFT)
    name = f"final error on a spring of {TOO_SOFT:g} N m/rad, K_P = {STIFF_LAW:g}"
    return ideal_and_bus(name, wanted, ideal, bus, "rad", 0.01)


def draw_errors(ideal: list[float], bus: list[float], ax: Axes) -> None:
    gains = np.linspace(12, 85, 300)
    ax.plot(gains, [joint.final_error(K) for K in gains], color=BLUE, label="k e = α sin e")
    plot_marks(ax, TRIED, ideal, bus, color=BLUE)
    for K_P, text in ((joint.CRITICAL, "exact bound"), (joint.SUFFICIENT, "bound of the proof")):
        level(ax, text, (K_P, 1.2), (3, 0), upright=True, rotation=90, va="center")
    ax.set_title("Where the link comes to rest")
    name_axes(ax, "gain on the motor, K_P (N m/rad)", "final error (rad)", "upper right")


def draw_afar(path: joint.Path, model: np.ndarray, ax: Axes) -> None:
    ax.plot(path.t, path.q_d - joint.UPRIGHT, color="0.5", ls="--", lw=1.2, label="goal")
    ax.plot(path.t, model - joint.UPRIGHT, color=ORANGE, label="on the joint's equations")
    t, q = path.t[::16], path.q[::16]
    ax.plot(t, q - joint.UPRIGHT, **MEASURED, color=ORANGE, label="measured on the bus")
    ax.set_xlim(-0.1, 3)
    ax.set_title(f"From {AFAR:g} rad away, K_P = {AFAR_K_P:g} N m/rad")
    name_axes(ax, "time since the goal left (s)", "angle from upright (rad)", "lower right")
