"""What a hand feels through the friction of geared joints, with dither and without."""

import numpy as np

from limber.paths import robot_folder
from limber.yaml_file import read_yaml
from limber_lecture import truth
from limber_lecture.context import Comparison, Context, at_least, at_most
from limber_lecture.pictures import BLACK, BLUE, GREEN, ORANGE, PINK, name_axes

TITLE = "A swing too small to see takes the friction out of what a hand feels"
CLAIM = "Friction between motor and link hides what is asked for"
SECTION = "3.2"
PLANT = "openarm on its buses with their time; the controller believes the shipped friction"
FAST = False

ROBOT = "openarm"
K_N_per_m = 500.0
PUSH_N = 9.0
PUSH_S, RAMP_S, PAUSE_S = 4.0, 0.3, 3.0
FIRST_S = 3.0
MEAN_S = 0.2  # five swings
AXES = ("x", "y", "z")
END_S = FIRST_S + len(AXES) * (PUSH_S + PAUSE_S)
FELT, BACK_mm, SWING_mm = 0.05, 1.0, 0.6


def run(context: Context) -> list[Comparison]:
    runs = {"none": moved(context, "none", 1.0)}
    checks = [
        at_least(f"without dither: felt along {axis}", 1.2 * K_N_per_m, felt, "N/m")
        for axis, (felt, _) in zip(AXES, measured(runs["none"]), strict=True)
    ]
    for scale in (0.5, 1.0, 2.0):
        runs[f"dither, friction x {scale:g}"] = found = moved(context, "dither", scale)
        name = f"friction x {scale:g}"
        for axis, (felt, back_mm) in zip(AXES, measured(found), strict=True):
            checks.append(Comparison(f"{name}: felt along {axis}", K_N_per_m, felt, "N/m", FELT))
            checks.append(at_most(f"{name}: left behind after {axis}", BACK_mm, back_mm, "mm"))
        checks.append(at_most(f"{name}: swing of the tip", SWING_mm, swing_mm(found), "mm"))
    draw(context, runs)
    return checks


def moved(context: Context, compensation: str, scale: float) -> np.ndarray:
    """Time and displacement of the tip from before the first push, s and mm."""
    joints = read_yaml(robot_folder(ROBOT) / "robot.yaml")["joints"]
    frictions = {name: dict(joint["friction"]) for name, joint in joints.items()}
    for friction in frictions.values():
        friction["coulomb_Nm"] *= scale
    gains = {
        "law": "cartesian_impedance",
        "K_x_translation_N_per_m": K_N_per_m,
        "K_x_rotation_Nm_per_rad": 20,
        "damping_ratio": 0.7,
        "friction_compensation": compensation,
        "ramp_s": 0.3,
    }
    scenario = {
        "robot": ROBOT,
        "duration_s": END_S,
        "wire": True,
        "plant_overrides": {"joints": {name: {"friction": f} for name, f in frictions.items()}},
        "timeline": [
            {"at_s": 0.3, "mode": "hold"},
            {"at_s": 0.8, "mode": "active"},
            {"at_s": 1.0, "gains": gains},
            *(push(i) for i in range(len(AXES))),
        ],
    }
    log = context.lab(scenario, f"{compensation}_{scale:g}".replace(".", "_"))
    rows = truth.motion(log, FIRST_S - MEAN_S, END_S)
    p = rows["p_BT"]
    t = rows["time_ns"] * 1e-9
    return np.column_stack([t, 1e3 * (p - p[t < FIRST_S].mean(axis=0))])


def begin_s(i: int) -> float:
    return FIRST_S + i * (PUSH_S + PAUSE_S)


def push(i: int) -> dict:
    force = [PUSH_N * (axis == i) for axis in range(3)]
    return {
        "at_s": begin_s(i),
        "push": {"id": i + 1, "force_N": force, "ramp_s": RAMP_S, "for_s": PUSH_S},
    }


def mean(run: np.ndarray, end_s: float) -> np.ndarray:
    rows = (run[:, 0] > end_s - MEAN_S) & (run[:, 0] <= end_s)
    return run[rows, 1:].mean(axis=0)


def measured(run: np.ndarray) -> list[tuple[float, float]]:
    """Of each push: the stiffness felt, N/m, and how far the tip stays from where it was, mm."""
    found = []
    for i in range(len(AXES)):
        before = mean(run, begin_s(i))
        pushed = mean(run, begin_s(i) + PUSH_S - RAMP_S)
        after = mean(run, begin_s(i) + PUSH_S + PAUSE_S)
        felt = 1e3 * PUSH_N / (pushed - before)[i]
        found.append((float(felt), float(np.linalg.norm(after - before))))
    return found


def swing_mm(run: np.ndarray) -> float:
    """From the middle, before the first push."""
    quiet = run[run[:, 0] < FIRST_S, 1:]
    return float(np.linalg.norm(quiet - quiet.mean(axis=0), axis=1).max())


def draw(context: Context, runs: dict[str, np.ndarray]) -> None:
    names = dict(zip(runs, ("no dither, friction x 1", *list(runs)[1:]), strict=True))
    colors = dict(zip(runs, (ORANGE, GREEN, BLUE, PINK), strict=True))
    with context.picture(TITLE, columns=3, size=(13.5, 4.6)) as axes:
        for i, (ax, axis) in enumerate(zip(axes, AXES, strict=True)):
            for name, run in runs.items():
                start = begin_s(i)
                rows = (run[:, 0] > start - 0.2) & (run[:, 0] < start + PUSH_S + PAUSE_S)
                moved_mm = run[rows, 1 + i] - mean(run, start)[i]
                ax.plot(run[rows, 0] - start, moved_mm, color=colors[name], lw=1, label=names[name])
            asked = 1e3 * PUSH_N / K_N_per_m
            ax.axhline(asked, color=BLACK, ls="--", lw=1, label=f"asked: 9 N / {K_N_per_m:g} N/m")
            ax.set_title(f"Pushed along {axis} for {PUSH_S:g} s")
            name_axes(ax, "time since the push began (s)", f"moved along {axis} (mm)")
        axes[1].legend(loc=(0.15, 0.3), fontsize=7.5)
