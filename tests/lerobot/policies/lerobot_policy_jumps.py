"""A policy of LeRobot's that is hard on an arm: poses 20 degrees apart without a way between them,
and pauses.
"""

import time
from dataclasses import dataclass

import torch
from lerobot.configs.policies import PreTrainedConfig
from lerobot.configs.types import FeatureType, PolicyFeature
from lerobot.policies.pretrained import PreTrainedPolicy
from lerobot.processor import (
    AddBatchDimensionProcessorStep,
    DeviceProcessorStep,
    PolicyProcessorPipeline,
    RenameObservationsProcessorStep,
)

AXES = 8  # seven joints and the gripper
JUMP = torch.tensor([20.0, 0, 0, -20.0, 0, 0, 0, -60.0])
CHUNK = 20


@PreTrainedConfig.register_subclass("jumps")
@dataclass
class JumpsConfig(PreTrainedConfig):
    """`pauses_s`: how long each chunk takes, in turn."""

    pauses_s: tuple[float, ...] = (0.0, 1.0)
    observation_delta_indices = action_delta_indices = reward_delta_indices = None

    def get_optimizer_preset(self):
        raise NotImplementedError

    def get_scheduler_preset(self):
        return None

    def validate_features(self):
        assert self.robot_state_feature.shape == (AXES,)


class JumpsPolicy(PreTrainedPolicy):
    config_class, name = JumpsConfig, "jumps"

    def __init__(self, config, **_):
        super().__init__(config)
        self.unused = torch.nn.Parameter(torch.zeros(1))
        self.reset()

    def reset(self):
        self.start, self.chunks, self.left = None, 0, []

    def predict_action_chunk(self, batch, **_):
        state = batch["observation.state"]
        assert state.shape == (1, AXES), state.shape
        if self.start is None:
            self.start = state[0].clone()
        time.sleep(self.config.pauses_s[self.chunks % len(self.config.pauses_s)])
        self.chunks += 1
        return (self.start + JUMP * (self.chunks % 2)).expand(1, CHUNK, AXES)

    def select_action(self, batch, **_):
        if not self.left:
            self.left = list(self.predict_action_chunk(batch)[0])
        return self.left.pop(0)[None]

    def forward(self, batch):
        raise NotImplementedError

    def get_optim_params(self):
        raise NotImplementedError


def write(folder, *pauses_s):
    """As if it had been trained."""
    config = JumpsConfig(
        input_features={"observation.state": PolicyFeature(FeatureType.STATE, (AXES,))},
        output_features={"action": PolicyFeature(FeatureType.ACTION, (AXES,))},
        device="cpu",
        pauses_s=pauses_s,
    )
    JumpsPolicy(config).save_pretrained(folder)
    rename = RenameObservationsProcessorStep(rename_map={})
    steps = [rename, AddBatchDimensionProcessorStep(), DeviceProcessorStep(device="cpu")]
    for name, chosen in (("policy_preprocessor", steps), ("policy_postprocessor", steps[2:])):
        PolicyProcessorPipeline(steps=chosen, name=name).save_pretrained(folder)


def serve():
    """LeRobot's policy server, which else takes the policies of its list alone."""
    from lerobot.async_inference import policy_server

    policy_server.SUPPORTED_POLICIES.append("jumps")
    policy_server.serve()
