"""Arms of limber's as Gymnasium environments, each on a lab of its own (limber.lab).

    env = gymnasium.make("limber.gym:limber/Reach-v0", control_mode="pd_joint_delta_pos")

limber/Reach-v0, limber/Push-v0, limber/Peg-v0; what they have in common: ArmEnv.
"""

from limber.errors import RunError
from limber.paths import command_for

try:
    import gymnasium
except ImportError as error:
    raise RunError(f"limber.gym needs gymnasium: {command_for('gymnasium')}") from error

from limber.gym.arm_env import ArmEnv
from limber.gym.peg import Peg
from limber.gym.push import Push
from limber.gym.reach import Reach

for _name, _steps in (("Reach", 100), ("Push", 200), ("Peg", 200)):
    if f"limber/{_name}-v0" not in gymnasium.registry:
        gymnasium.register(
            f"limber/{_name}-v0",
            entry_point=f"limber.gym.{_name.lower()}:{_name}",
            max_episode_steps=_steps,
        )

__all__ = ["ArmEnv", "Peg", "Push", "Reach"]
