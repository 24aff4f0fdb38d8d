"""The reward is the sum of its parts."""

import numpy as np
import pytest

from clean_swarm_env.reward import RewardConfig, rewards


def test_the_reward_is_the_weighted_sum_of_its_parts():
    config = RewardConfig(dumped=2.0, time=-0.5, collision=-0.25)
    gained = rewards(config, np.array([1, 0]), np.array([1.0, 0.4]), np.array([0, 1, 2, 0]), robots=2)
    assert gained.tolist() == pytest.approx([1.5, 1.25, -0.7, -0.2])


def test_misspelt_weights_are_refused():
    with pytest.raises(ValueError, match="colision"):
        RewardConfig(colision=1.0)
