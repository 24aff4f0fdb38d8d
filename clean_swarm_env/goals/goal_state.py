"""The global state of worlds with a goal: robots, things around, facts, options and time.

Shapes: W worlds, G components.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from clean_swarm_env.goals.observer import kinds_of
from clean_swarm_env.goals.play import Play
from clean_swarm_env.learning.observation.observer import Observations
from selforg.arrays import Floats
from selforg.elementary import unit_vectors

POSE = ("x", "y", "heading_cos", "heading_sin")


class Playing(Protocol):
    """Whatever has an episode under way."""

    play: Play


class GoalState:
    """The components of the global state of each world, within [-1, 1].

    `names` names them: `robot_K_NAME` (`POSE`, facts, `holds_OPTION`), `KIND_K_x` and `KIND_K_y` of the things around,
    and `time`, the share of the episode that has passed. Places go from -1 to 1 along each side of the torus. On open
    land they are offsets from the middle by the side of the field; those beyond are cut off.

    Args:
        owner: has the episode under way.
        options: whether robots hold options.

    """

    def __init__(self, owner: Playing, *, options: bool) -> None:
        self._owner, self._options = owner, options
        shown = owner.play
        held = [f"holds_{option}" for option in shown.team.options] if options else []
        robots = range(shown.scene.arena.robots)
        kinds = zip(kinds_of(shown), shown.scene.around, strict=True)
        things = [f"{kind}_{k}_{axis}" for kind, lying in kinds for k in range(lying.places.shape[1]) for axis in "xy"]
        own = (*POSE, *shown.facts, *held)
        self.names = (*(f"robot_{k}_{name}" for k in robots for name in own), *things, "time")

    def now(self) -> Observations:
        """Return the state (W, G) of the worlds as they are."""
        play = self._owner.play
        scene, team = play.scene, play.team
        parts = [self._places(scene.arena.positions), *unit_vectors(scene.arena.headings)]
        parts += [team.memory[name].values for name in play.facts]
        if self._options:
            parts.append(np.eye(len(team.options))[team.held])
        things = [self._places(kind.places).reshape(scene.arena.worlds, -1) for kind in scene.around]
        time = np.full((scene.arena.worlds, 1), scene.arena.ticks / scene.chosen.ticks)
        robots = np.column_stack(parts).reshape(scene.arena.worlds, -1)
        return np.concatenate([robots, *things, time], axis=1).astype(np.float32)

    def _places(self, points: Floats) -> Floats:
        ground = self._owner.play.scene.ground
        scale = 0.5 * ground.side if ground.kind == "torus" else ground.field_side
        places: Floats = np.clip((points - ground.centre) / scale, -1.0, 1.0)
        return places
