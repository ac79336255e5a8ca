"""Two joints with variable springs that shall give the tip a stiffness: what is really there."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.integrate import solve_ivp

from limber_lecture import planar2r as arm
from limber_lecture.context import Comparison, Context, case, near_zero
from limber_lecture.probing import Probing
from limber_lecture.timeline import tip_gains
from limber_lecture.truth import joints, motion
from limber_lecture.variants import friction, variant

from .pair import K_2, tension

ROBOT = "antagonist2r"
ASKED = 600.0  # N/m, the same along x and y
FORCE = 0.5  # N, of the pushes
DAMPING = np.array([6.0, 3.0])  # N m s/rad of the link, so that an arm that is pushed rests
PROBED = Probing(first_at=3.0, each_s=2.0, axes=2, force=2.0)
ELBOWS = np.array([0.4, 0.9, 1.5, 2.0, np.arccos(-0.8), 2.7])


@dataclass(frozen=True)
class Case:
    """An arm at rest in a pose, perhaps under a load (N)."""

    name: str
    q: np.ndarray
    load: np.ndarray

    @property
    def J(self) -> np.ndarray:
        return arm.jacobian(self.q)

    @property
    def K_G(self) -> np.ndarray:
        return arm.geometric(self.q, self.load)

    @property
    def sigma(self) -> np.ndarray:
        """The diagonal nearest to what Eq. 4 wants."""
        return np.diag(self.J.T @ (ASKED * np.eye(2)) @ self.J + self.K_G)

    def presented(self, sigma: np.ndarray | None = None) -> np.ndarray:
        """J⁻ᵀ (diag σ - K_G) J⁻¹."""
        inverse = np.linalg.inv(self.J)
        return inverse.T @ (np.diag(self.sigma if sigma is None else sigma) - self.K_G) @ inverse


def outwards(q: np.ndarray) -> np.ndarray:
    return arm.tip(q) / np.linalg.norm(arm.tip(q))


FREE = Case("no load", np.array([0.5, 1.9]), np.zeros(2))
LOADED = replace(FREE, name="pulled outwards by 20 N", load=20.0 * outwards(FREE.q))
EXACT = replace(FREE, name="no load, cos q₂ = -0.8", q=np.array([0.5, np.arccos(-0.8)]))
CASES = (FREE, LOADED, EXACT)


def residual(q: np.ndarray) -> float:
    """√2 |p·p₂| / √(|p|⁴ + 2 (p·p₂)² + l₂⁴) of an isotropic wish."""
    p, p_2 = arm.tip(q), arm.elbow_to_tip(q)
    whole = (p @ p) ** 2 + 2 * (p @ p_2) ** 2 + arm.LENGTHS[1] ** 4
    return float(np.sqrt(2) * abs(p @ p_2) / np.sqrt(whole))


def residuals(context: Context) -> np.ndarray:
    """The controller's, at each angle of the elbow."""
    asked = [
        case("vsa_cartesian", arm.ROBOT, q=[0.5, elbow], Kx=[ASKED, ASKED]) for elbow in ELBOWS
    ]
    return np.array([answer["residual_stiffness"] for answer in context.eval(asked)])


def ideal(wanted: Case) -> np.ndarray:
    """Stiffness felt: the arm with its four tendons is pushed, and swings until it rests."""
    e = wanted.q - wanted.J.T @ wanted.load / wanted.sigma  # τ = σ (e - q) = -Jᵀ F
    c = wanted.sigma / (2 * K_2)

    def rate(_: float, x: np.ndarray, force: np.ndarray) -> np.ndarray:
        q, v = x[:2], x[2:]
        springs = tension(c + e - q) - tension(c - e + q)
        torque = springs + arm.jacobian(q).T @ force - DAMPING * v - arm.coriolis(q, v)
        return np.concatenate([v, np.linalg.solve(arm.inertia(q), torque)])

    def rest(force: np.ndarray) -> np.ndarray:
        start = np.concatenate([wanted.q, np.zeros(2)])
        end = solve_ivp(rate, (0, 4.0), start, args=(wanted.load + force,), rtol=1e-8, atol=1e-10)
        return arm.tip(end.y[:2, -1])

    moved = [(rest(f) - rest(-f)) / (2 * FORCE) for f in FORCE * np.eye(2)]
    return np.linalg.inv(np.column_stack(moved))


def lying(context: Context, name: str) -> str:
    """The arm without gravity or motor friction; its bearings damp, so that it comes to rest."""
    changed = {
        joint: {"friction": friction(), "link_friction": friction(viscous=d)}
        for joint, d in zip(("shoulder", "elbow"), DAMPING, strict=True)
    }
    changes = {"gravity_m_per_s2": [0.0, 0.0, -9.81], "joints": changed}
    return variant(context.out / name, ROBOT, changes)


def bus(context: Context, wanted: Case) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness felt on the arm with four drives, and the joint stiffnesses its springs have."""
    name = f"tip_{CASES.index(wanted)}"
    law = {"law": "variable_stiffness", "stiffness_fit": "diagonal"}
    gains = tip_gains([ASKED, ASKED, 0.0], **law)
    load = np.array([*wanted.load, 0.0])
    entries = [
        {"at_s": 1.2, "goal": {"force_N": -load}},
        {"at_s": 1.2, "push": {"force_N": load, "ramp_s": 0.1, "for_s": PROBED.end}},
        *PROBED.timeline(),
    ]
    robot, q = lying(context, name), wanted.q
    log = context.run_law(name, robot, gains, entries, PROBED.end, start_q=q)
    rows = motion(log, PROBED.first_at - 0.1, PROBED.first_at)
    return PROBED.stiffness(log), joints(rows, "sigma").mean(axis=0)


Tips = dict[str, dict[str, np.ndarray]]


def found(context: Context) -> tuple[Tips, dict[str, np.ndarray]]:
    """Tip stiffness felt in each case, ideal and on the bus; joint stiffness of the springs."""
    tips, springs = {}, {}
    for wanted in CASES:
        felt, springs[wanted.name] = bus(context, wanted)
        tips[wanted.name] = {"ideal": ideal(wanted), "bus": felt}
    return tips, springs


def checks(tips: Tips, springs: dict[str, np.ndarray], shares: np.ndarray) -> list[Comparison]:
    formula = np.array([residual(np.array([0.5, elbow])) for elbow in ELBOWS])
    differ, exact = np.abs(shares - formula).max(), np.argmin(np.abs(ELBOWS - np.arccos(-0.8)))
    name = "2R, share of the wish that is missed: formula and controller differ by"
    made = [
        near_zero(name, differ, "", 1e-9),
        near_zero("2R, share missed where cos q₂ = -l₂/l₁", shares[exact], "", 1e-6),
    ]
    for wanted in CASES:
        for i, joint in enumerate(("shoulder", "elbow")):
            name = f"{wanted.name}, bus: stiffness of the {joint}'s springs"
            seen = springs[wanted.name][i]
            made.append(Comparison(name, wanted.sigma[i], seen, "N m/rad", 0.01))
        for where, K in tips[wanted.name].items():
            for i, word in enumerate(("soft", "stiff")):
                asked, got = (np.linalg.eigvalsh((A + A.T) / 2)[i] for A in (wanted.presented(), K))
                name = f"{wanted.name}, {where}: tip along its {word} axis"
                made.append(Comparison(name, asked, got, "N/m", 0.02))
    return made
