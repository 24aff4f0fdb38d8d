"""The settings of a batch with a goal: its scene, its reward and its observations."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Annotated, Any, Literal, TypedDict, get_args

import numpy as np
from pydantic import Field, create_model

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.config.types import Robots, Seconds
from clean_swarm_env.learning.actions import Mode
from clean_swarm_env.learning.given import Named, config_from
from clean_swarm_env.recording.recorder import RecordSettings
from clean_swarm_env.scenes.ground import GroundKind
from clean_swarm_env.scenes.scene import Scene, Setting
from selector.documents.fields import Closed, NonNegative, Number, Positive
from selforg.arrays import Floats, Ints

GoalTerm = Literal["command", "around", "neighbour", "movement", "facts", "time", "holds"]
OWN_COLLISION = "collision"
"""Key of the weight for each collision event in which the robot took part [1/event]."""


class GoalAction(Closed):
    """The actions of a learner of a goal, one in each decision period."""

    mode: Mode = "option"
    """Whether an action is the option of the goal, the movement vector in the robot's frame, or both: an option and a
    correction of its movement."""


class GoalObservation(Closed):
    """What a learner sees of each robot that has a goal: terms in their order, and their settings."""

    terms: Annotated[tuple[GoalTerm, ...], Field(min_length=1)] = get_args(GoalTerm)
    """The terms; see `clean_swarm_env.goals.observer.TERMS_OF_GOALS`."""
    sight: NonNegative = 2.0
    """How far beyond the reach of a thing a robot sees it [m]."""
    neighbour_range: Positive = 2.5
    """Centre distance within which robots are neighbours [m]."""

    def driven(self) -> GoalObservation:
        """Return the observation of robots that are driven by vectors: they hold no options."""
        if "holds" in self.terms and "terms" in self.model_fields_set:
            raise ConfigurationError("observation: terms: 'holds': expected options as actions, got mode 'velocity'")
        return self.model_copy(update={"terms": tuple(term for term in self.terms if term != "holds")})


class SceneChanges(Closed):
    """Changes of the scene's own setting; what is None stays."""

    robots: Robots | None = None
    """Number of robots."""
    seconds: Seconds | None = None
    """Simulated time of an episode [s]."""
    ground: GroundKind | None = None
    """Kind of ground: "torus" or "open"."""


class GoalSettings(TypedDict, total=False):
    """Further settings of a batch with a goal, as keyword arguments."""

    robots: int | None
    """Number of robots; the scene's own unless given."""
    seconds: float | None
    """Simulated time of an episode [s]; the scene's own unless given."""
    ground: GroundKind | None
    """Kind of ground; the scene's own unless given."""
    knowledge: Named | None
    """Name or path of the expert knowledge with the options of the goal, "library" unless given."""
    directories: Named | Iterable[Named]
    """The user's own configurations and knowledge, searched before the shipped ones."""
    begin_anew: bool
    """Whether all worlds begin their next episode at the end of the period that ends one, by default yes."""
    record: RecordSettings | None
    """Where the episodes are recorded; they are not unless given."""


def setting_of(scene: type[Scene], settings: GoalSettings) -> Setting:
    """Return the setting of a scene with the user's changes; DocumentError names what does not fit."""
    given = {name: settings[name] for name in SceneChanges.model_fields if name in settings}  # type: ignore[literal-required]
    changes = config_from(SceneChanges, given, scene.goal)
    own = scene.setting
    return Setting(changes.robots or own.robots, changes.seconds or own.seconds, changes.ground or own.ground)


def key_of(measure: str) -> str:
    """Return the name of a measure as it stands in infos and rewards: letters, digits and underscores."""
    return re.sub(r"\W+", "_", measure)


class GoalRewards:
    """Rewards of a goal: by how much each measure has become better in a period, in units of its target.

    The sum over an episode is thus the measure at the end, less the measure at the start, by its target; with the sign
    of "better". All robots of a world are paid alike. Weights are 1 unless given, that of `collision` 0.

    Attributes:
        weights: key of a measure, or `collision` -> weight.

    """

    def __init__(self, scene: type[Scene], given: Mapping[str, Any] | None) -> None:
        keys = [key_of(measure.name) for measure in scene.measures]
        fields: dict[str, Any] = dict.fromkeys(keys, (Number, 1.0)) | {OWN_COLLISION: (Number, 0.0)}
        chosen = config_from(create_model("GoalWeights", __base__=Closed, **fields), given, "reward")
        self.weights: dict[str, float] = chosen.model_dump()
        signs = [1.0 if measure.better == "higher" else -1.0 for measure in scene.measures]
        units = [abs(measure.target) or 1.0 for measure in scene.measures]
        self._prices = np.array([self.weights[key] for key in keys]) * signs / units

    def of(self, gained: Floats, collisions: Ints) -> Floats:
        """Return the rewards (R,) of changes of the measures (K, W) and of collision events (R,) in a period."""
        team = self._prices @ gained
        return np.repeat(team, len(collisions) // len(team)) + self.weights[OWN_COLLISION] * collisions
