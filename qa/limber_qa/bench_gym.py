"""Steps a second of limber.gym's Reach at 20 Hz, beside MuJoCo with the same law in Python.

    python -m limber_qa.bench_gym

A step is 50 ms of arm time. MuJoCo (if it is there) steps the model of `limber export mjcf` by
1 ms; `bare`: without a law; `with a law`: F = K e - D v at the tip by its own Jacobian, and the
weight, once a step of 1 ms as limber's. limber's has driver, bus and watches besides. The readers
take turns, the best of all turns counts. Then labs in as many threads: cycles a second of all.
"""

import importlib.util
import os
import platform
import threading
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from limber.export import mjcf
from limber.gym import Reach
from limber.lab import Lab
from limber.model.robot import load_robot
from limber.paths import RELEASE

TURNS, STEPS = 5, 100
HZ, SUBSTEPS = 20, 50
DAMPING_RATIO = 0.7
THREAD_CYCLES = 20_000


def limber_steps() -> Callable[[], None]:
    env = Reach()
    env.reset(seed=1)

    def run() -> None:
        for _ in range(STEPS):
            env.step(np.zeros(6))

    return run


def mujoco_steps(law: bool) -> Callable[[], None]:
    """tau = Jᵀ (K e - D J v) + g + C v, with e of the translation; D for a mass of a kilogram."""
    import mujoco

    robot = load_robot("openarm")
    model = mujoco.MjModel.from_xml_string(mjcf.text(robot))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    K, J, e = robot.K_x, np.zeros((6, model.nv)), np.zeros(6)
    D = 2.0 * DAMPING_RATIO * np.sqrt(K)
    start = data.site_xpos[0].copy()

    def run() -> None:
        for _ in range(STEPS * SUBSTEPS):
            if law:
                mujoco.mj_jacSite(model, data, J[:3], J[3:], 0)
                e[:3] = start - data.site_xpos[0]
                data.ctrl[:] = J.T @ (K @ e - D @ (J @ data.qvel)) + data.qfrc_bias
            mujoco.mj_step(model, data)

    return run


def best_rates(runs: dict[str, Callable[[], None]]) -> dict[str, float]:
    """Steps a second, processor time."""
    best = dict.fromkeys(runs, 0.0)
    for _ in range(TURNS):
        for name, run in runs.items():
            begun = time.process_time()
            run()
            best[name] = max(best[name], STEPS / (time.process_time() - begun))
    return best


def cycles_per_s(threads: int) -> float:
    """Of all labs together, by the clock."""
    labs = [Lab({"robot": "openarm", "integrator": "reference"}) for _ in range(threads)]
    begun = time.perf_counter()
    workers = [threading.Thread(target=lab.step, args=(THREAD_CYCLES,)) for lab in labs]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    return threads * THREAD_CYCLES / (time.perf_counter() - begun)


def instruction_set() -> str:
    """The widest vectors that the processor has."""
    info = Path("/proc/cpuinfo")
    words = info.read_text(encoding="utf-8").split() if info.is_file() else []
    return next((word for word in ("avx512f", "avx2", "asimd") if word in words), "") or (
        platform.machine()
    )


def main() -> None:
    if RELEASE.is_dir():
        os.environ.setdefault("LIMBER_BIN", str(RELEASE))
    runs = {f"limber/Reach-v0, {HZ} Hz": limber_steps()}
    if importlib.util.find_spec("mujoco"):
        runs["MuJoCo with a law in Python"] = mujoco_steps(law=True)
        runs["MuJoCo bare"] = mujoco_steps(law=False)
    drawn = Table(
        f"steps of 50 ms, one thread ({instruction_set()})", "a second", "times real time"
    )
    for name, rate in best_rates(runs).items():
        drawn.add_row(name, f"{rate:.0f}", f"{rate / HZ:.1f}")
    for threads in (1, os.cpu_count() or 1):
        drawn.add_row(f"cycles of {threads} labs in threads", f"{cycles_per_s(threads):.0f}", "")
    Console().print(drawn)


if __name__ == "__main__":
    main()
