"""Parts of a scenario that several experiments need: gains at the tip, pushes one after another."""

from collections.abc import Iterable
from typing import Any

from numpy.typing import ArrayLike

# More than any run needs: the spring of a law is not to saturate
UNBOUNDED = {"spring_force_N": 1000.0, "spring_moment_Nm": 1000.0}


def tip_gains(
    K: ArrayLike, K_turn: ArrayLike = 0.0, law: str = "cartesian_impedance", **more: Any
) -> dict[str, Any]:
    """Stiffness of the tip, N/m and N m/rad: one number, or three along the axes."""
    stiffness = {"K_x_translation_N_per_m": K, "K_x_rotation_Nm_per_rad": K_turn}
    return {"law": law, **stiffness, **more}


def in_turn(
    first_at: float, each_s: float, pushes: Iterable[dict[str, Any]], **shape: Any
) -> list[dict[str, Any]]:
    """One push every `each_s`; `shape` is what they share, such as ramp_s and for_s."""
    return [
        {"at_s": first_at + each_s * i, "push": {**push, **shape}} for i, push in enumerate(pushes)
    ]


def joint_damping(D: ArrayLike) -> dict[str, Any]:
    """Gains: the damping of the joints is this, N m s/rad, and not designed."""
    return {"joint_damping": "given", "D_q_Nms_per_rad": D}
