"""Registration of the environments by their ids.

    import gymnasium, pettingzoo
    import clean_swarm_env.registration

    team = gymnasium.make("CleanSwarm-v0")
    teams = gymnasium.make_vec("CleanSwarm-v0", num_envs=64)
    env = pettingzoo.make("parallel", "CleanSwarm-v0")

Importing this module registers the ids; `gymnasium.make("clean_swarm_env.registration:CleanSwarm-v0")` does so too.
"""

from __future__ import annotations

from typing import Any

import gymnasium
import pettingzoo

TEAM_ID, ONE_FOR_ALL_ID = "CleanSwarm-v0", "CleanSwarmOneForAll-v0"


def register_gymnasium() -> None:
    """Register the environments of Gymnasium; those that are registered already stay as they are."""
    specs: dict[str, dict[str, Any]] = {
        TEAM_ID: {
            "entry_point": "clean_swarm_env.borders.gymnasium_team:CleanSwarmTeam",
            "vector_entry_point": "clean_swarm_env.borders.gymnasium_vector:TeamVectorEnv",
        },
        ONE_FOR_ALL_ID: {
            "entry_point": "clean_swarm_env.borders.gymnasium_team:CleanSwarmTeam",
            "vector_entry_point": "clean_swarm_env.borders.gymnasium_vector:TeamVectorEnv",
            "kwargs": {"one_for_all": True},
        },
    }
    for name, spec in specs.items():
        if name not in gymnasium.registry:
            gymnasium.register(name, **spec)


def register_pettingzoo() -> None:
    """Register the environments of PettingZoo; those that are registered already stay as they are."""
    for kind, entry in (("parallel", "parallel_env"), ("aec", "env")):
        registry = pettingzoo.parallel_registry if kind == "parallel" else pettingzoo.aec_registry
        if TEAM_ID not in registry:
            pettingzoo.register(kind, TEAM_ID, f"clean_swarm_env.clean_swarm_v0:{entry}")


register_gymnasium()
register_pettingzoo()
