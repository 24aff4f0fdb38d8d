"""The public name of the border to Stable-Baselines3."""

from clean_swarm_env.borders.stable_baselines3 import *  # noqa: F403  (every public name of that file)
