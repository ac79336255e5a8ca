"""A mass on a spring that is soft on the way out and stiff on the way back."""

import math

import numpy as np

from limber_lecture.plants import held, mass

m, K_OUT, K_IN, STEP_S = 1.0, 100.0, 150.0, 5e-5


def half_cycle(D: float) -> float:
    """How much the amplitude grows from one turning point to the next: the exact solution.

    √(K_in/K_out) e^{-σ t}, σ = D/2m, t = [π - atan(ω_in/σ)]/ω_in + atan(ω_out/σ)/ω_out, with the
    damped frequencies ω.
    """
    sigma = D / (2 * m)
    inward, outward = (math.sqrt(K / m - sigma**2) for K in (K_IN, K_OUT))
    t = (math.pi - math.atan2(inward, sigma)) / inward + math.atan2(outward, sigma) / outward
    return math.sqrt(K_IN / K_OUT) * math.exp(-sigma * t)


def stepped(D: float, half_cycles: int = 6) -> float:
    """The same by stepping: the mean factor from turning point to turning point."""
    springs = {K: held(*mass(m, D, K), STEP_S)[0] for K in (K_OUT, K_IN)}
    state, peaks = np.array([0.1, 0.0]), [0.1]
    while len(peaks) <= half_cycles:
        outward = state[0] * state[1] > 0
        after = springs[K_OUT if outward else K_IN] @ state
        if outward and after[0] * after[1] <= 0:
            peaks.append(abs(after[0]))
        state = after
    return (peaks[-1] / peaks[0]) ** (1 / half_cycles)
