"""Registration of the environments by their ids with Gymnasium and PettingZoo.

    import gymnasium, pettingzoo
    import clean_swarm_env.registration

    team = gymnasium.make("CleanSwarm-v0")
    teams = gymnasium.make_vec("CleanSwarm-v0", num_envs=64)
    env = pettingzoo.make("parallel", "CleanSwarm-v0")

    rooms = gymnasium.make("CleanSwarm-Rooms-v1", size=(14.0, 10.0))

The family `rooms-1` has the id `CleanSwarm-Rooms-v1`, and so on; `evaluate` and `parallel_env` take it, too.
Importing this module registers the ids; `gymnasium.make("clean_swarm_env.registration:CleanSwarm-v0")` does so too.
"""

from __future__ import annotations

from typing import Any

import gymnasium
import pettingzoo

from clean_swarm_env.config.task_names import family_ids

TEAM_ID, ONE_FOR_ALL_ID = "CleanSwarm-v0", "CleanSwarmOneForAll-v0"

_TEAMS: dict[str, dict[str, Any]] = {TEAM_ID: {}, ONE_FOR_ALL_ID: {"one_for_all": True}}
_FAMILIES = {own: {"family": own} for own in family_ids()}
for _id, _settings in {**_TEAMS, **_FAMILIES}.items():
    gymnasium.register(
        _id,
        entry_point="clean_swarm_env.borders.gymnasium_team:CleanSwarmTeam",
        vector_entry_point="clean_swarm_env.borders.gymnasium_vector:TeamVectorEnv",
        kwargs=_settings,
    )
for _id, _settings in {TEAM_ID: {}, **_FAMILIES}.items():
    pettingzoo.register("parallel", _id, "clean_swarm_env.clean_swarm_v0:parallel_env", kwargs=_settings)
    pettingzoo.register("aec", _id, "clean_swarm_env.clean_swarm_v0:env", kwargs=_settings)
