"""Registration of the environments by their ids with Gymnasium and PettingZoo.

    import gymnasium, pettingzoo
    import clean_swarm_env.registration

    team = gymnasium.make("CleanSwarm-v0")
    teams = gymnasium.make_vec("CleanSwarm-v0", num_envs=64)
    env = pettingzoo.make("parallel", "CleanSwarm-v0")

Importing this module registers the ids; `gymnasium.make("clean_swarm_env.registration:CleanSwarm-v0")` does so too.
"""

from __future__ import annotations

import gymnasium
import pettingzoo

TEAM_ID, ONE_FOR_ALL_ID = "CleanSwarm-v0", "CleanSwarmOneForAll-v0"

for _name, _settings in ((TEAM_ID, {}), (ONE_FOR_ALL_ID, {"one_for_all": True})):
    gymnasium.register(
        _name,
        entry_point="clean_swarm_env.borders.gymnasium_team:CleanSwarmTeam",
        vector_entry_point="clean_swarm_env.borders.gymnasium_vector:TeamVectorEnv",
        kwargs=_settings,
    )
for _kind, _entry in (("parallel", "parallel_env"), ("aec", "env")):
    pettingzoo.register(_kind, TEAM_ID, f"clean_swarm_env.clean_swarm_v0:{_entry}")
