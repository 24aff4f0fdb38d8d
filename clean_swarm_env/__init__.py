"""The cleaning world, its mission and its RL borders (knows selforg and selector).

The names below can be imported from here. Environments have modules of their own: `clean_swarm_v0` (PettingZoo),
`registration` (the ids of Gymnasium and PettingZoo) and `sb3` (Stable-Baselines3).
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

import clean_swarm_env.siblings as siblings

__version__ = "1.0.0"
"""Version of Clean Swarm: the only place that has it; the wheel takes it from here (docs/versions.md)."""

siblings.own("selforg")
siblings.own("selector")

if TYPE_CHECKING:  # importing these takes seconds, which `clean-swarm --help` cannot wait for: see `__getattr__`
    from clean_swarm_env.config.families import FamilyConfig as FamilyConfig
    from clean_swarm_env.config.load import load_family as load_family
    from clean_swarm_env.config.load import load_mission as load_mission
    from clean_swarm_env.config.mission import MissionConfig as MissionConfig
    from clean_swarm_env.config.mission import StartConfiguration as StartConfiguration
    from clean_swarm_env.config.types import ConfigurationError as ConfigurationError
    from clean_swarm_env.learning.actions import ActionConfig as ActionConfig
    from clean_swarm_env.learning.batch import Batch as Batch
    from clean_swarm_env.learning.batch import mission_begun as mission_begun
    from clean_swarm_env.learning.batch import run_out as run_out
    from clean_swarm_env.learning.joined import batches_of as batches_of
    from clean_swarm_env.learning.observation.config import ObservationConfig as ObservationConfig
    from clean_swarm_env.learning.observation.term import TERMS as TERMS
    from clean_swarm_env.learning.observation.term import Term as Term
    from clean_swarm_env.learning.reward import RewardConfig as RewardConfig

MODULE_OF = {
    "ConfigurationError": "config.types",
    "FamilyConfig": "config.families",
    "load_family": "config.load",
    "load_mission": "config.load",
    "MissionConfig": "config.mission",
    "StartConfiguration": "config.mission",
    "ActionConfig": "learning.actions",
    "Batch": "learning.batch",
    "mission_begun": "learning.batch",
    "run_out": "learning.batch",
    "batches_of": "learning.joined",
    "TERMS": "learning.observation.term",
    "Term": "learning.observation.term",
    "ObservationConfig": "learning.observation.config",
    "RewardConfig": "learning.reward",
}
"""Public name -> module of this package that defines it."""


def __getattr__(name: str) -> Any:  # noqa: ANN401  (any public name; type checkers see the imports above)
    """Import a public name when it is first used."""
    if name not in MODULE_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{MODULE_OF[name]}"), name)
    globals()[name] = value
    return value
