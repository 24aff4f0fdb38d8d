"""Importing this module registers the environments with Gymnasium and PettingZoo."""

from clean_swarm_env.borders import registration as _registration  # noqa: F401  (registers)
