"""The settings that all borders take, and signatures that spell them out."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from typing import Any, TypeVar, get_args, get_type_hints

from clean_swarm_env.learning.episodes import EnvSettings
from clean_swarm_env.learning.given import GivenMission
from clean_swarm_env.learning.reward import OwnRewards, RewardConfig

Border = TypeVar("Border", bound=Callable[..., Any])
GivenReward = RewardConfig | Mapping[str, Any] | OwnRewards | str
"""Weights of the reward's terms, a function of the batch, or `module:function`."""


class VectorSettings(EnvSettings, total=False):
    """Settings of a vectorised environment, as keyword arguments."""

    mission: GivenMission | None
    """Its name in `configs/missions` ("table1" unless given), its path, its keys, or the model."""
    reward: GivenReward | None
    """Weights of the reward's terms, or a function, see `Batch`."""


def spelled_out(function: Border) -> Border:
    """Make `help` show each of the settings of a function with `**settings: Unpack[...]`."""
    signature = inspect.signature(function)
    *parameters, last = signature.parameters.values()
    (settings,) = get_args(get_type_hints(function)[last.name])
    for name, hint in settings.__annotations__.items():
        text = hint.__forward_arg__
        default = None if text.endswith("None") else ...
        parameters.append(inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=text))
    vars(function)["__signature__"] = signature.replace(parameters=parameters)
    return function
