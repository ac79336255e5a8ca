"""Which runs a sweep has: shares of each variation's way, run by run, the same on any machine."""

import math

import numpy as np

from limber.arrays import Floats
from limber.errors import InputError
from limber.sweep.variation import Variation

METHODS = ("lhs", "grid", "monte-carlo")


def shares(method: str, vary: tuple[Variation, ...], runs: int, seed: int) -> Floats:
    """Runs x variations, 0 to 1. A grid has as many points along each range as `runs` allow."""
    if method == "grid":
        return _grid(vary, runs)
    random = np.random.Generator(np.random.PCG64(seed))
    if method == "monte-carlo":
        return random.random((runs, len(vary)))
    # Latin hypercube (McKay, Beckman and Conover, 1979): one run in each of as many strata.
    strata = np.column_stack([random.permutation(runs) for _ in vary])
    found: Floats = (strata + random.random(strata.shape)) / runs
    return found


def seed_of(seed: int, run: int) -> int:
    """The scenario's own, of a run."""
    return int(np.random.SeedSequence([seed, run]).generate_state(1)[0])


def _grid(vary: tuple[Variation, ...], runs: int) -> Floats:
    lists = math.prod(len(variation.values) for variation in vary if variation.values)
    ranges = sum(not variation.values for variation in vary)
    most = 1
    while ranges and lists * (most + 1) ** ranges <= runs:
        most += 1
    if runs < lists or (ranges and most < 2):
        raise InputError(f"--runs {runs}: this grid has {lists * 2**ranges} runs or more")
    axes = [
        (np.arange(len(v.values)) + 0.5) / len(v.values) if v.values else np.linspace(0, 1, most)
        for v in vary
    ]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(vary))
