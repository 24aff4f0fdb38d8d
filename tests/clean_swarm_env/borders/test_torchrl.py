"""TorchRL's PettingZoo wrapper: 1,000 random steps.

TorchRL is no dependency of the project; `pip install torchrl` beside the extra `train` runs this test.
"""

import pytest

pytest.importorskip("torchrl", reason="needs torchrl, which is not installed")

import torch
from torchrl.envs import PettingZooWrapper
from torchrl.envs.utils import check_env_specs

from clean_swarm_env import clean_swarm_v0
from tests.clean_swarm_env.courses import long_course, mission


@long_course
@pytest.mark.filterwarnings("ignore")
def test_a_thousand_random_steps_through_torchrl():
    parallel = clean_swarm_v0.parallel_env(mission(time_limit=200.0))
    env = PettingZooWrapper(parallel, use_mask=False, categorical_actions=True, seed=1)
    check_env_specs(env)
    env.set_seed(1)
    rollout = env.rollout(1000, break_when_any_done=False)
    assert rollout.batch_size[0] == 1000
    assert rollout["next", "robot", "observation"].shape[1:] == (5, parallel.observation_space("robot_0").shape[0])
    assert torch.isfinite(rollout["next", "robot", "reward"]).all()
    assert int(rollout["next", "done"].sum()) >= 5
    assert not (rollout["next", "terminated"] & rollout["next", "truncated"]).any()
