"""The global state of a world, for learners that see everything: bodies, cargo, items, stations, options, time.

Shapes: W worlds, N robots, M items, G components. Every component lies within [-1, 1].
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.config.cleaning import StationsConfig
from clean_swarm_env.learning.observation.thing_terms import kinds_of
from clean_swarm_env.learning.progress import MissionProgress
from clean_swarm_env.world.cleaning.garbage import ABSENT, CARRIED, DONE, LYING, NOTHING
from clean_swarm_env.world.worlds import Worlds
from selforg.arrays import Floats, Ints
from selforg.elementary import unit_vectors

ROBOT = ("works", "x", "y", "heading_cos", "heading_sin", "carrying", "recycled")
ITEM = ("lying", "carried", "done", "x", "y")
STATION = ("x", "y")
STATION_KINDS = ("recycling", "dump")


class GlobalState:
    """The components of the global state of each world.

    `names` names them: `robot_K_NAME` (`ROBOT`, then `holds_OPTION` or with several goals `holds_GOAL_OPTION`),
    `item_K_NAME` (`ITEM`), `recycling_x`, `recycling_y`, `dump_x`, `dump_y`, then further stations as `recycling_2_x`,
    `time` and `garbage_done`. Places go from -1 to 1 along each side of the torus; that of an item is where it lies or
    was picked. `time` is the share of the time limit that has passed, `garbage_done` the share of the items dumped of
    those that arrived. The other components are flags, except cosine and sine. What is not there is 0.

    A task other than cleaning has facts in place of cargo, and its things (`KIND_K_x`) in place of items and stations;
    on open land places are offsets from the middle.

    Args:
        worlds: the worlds.
        progress: has the time limits of their missions.
        options: whether robots hold options; not if they are driven by vectors.

    Attributes:
        names: (G,) names of the components.
        final: (W, G) state at the end of the last mission of each world, zeros before.

    """

    def __init__(self, worlds: Worlds, progress: MissionProgress, *, options: bool) -> None:
        self._worlds, self._progress = worlds, progress
        self._coordinators = worlds.coordinators if options else ()
        several = len(self._coordinators) > 1
        holds = [
            f"holds_{c.model.goal}_{option}" if several else f"holds_{option}"
            for c in self._coordinators
            for option in c.model.options
        ]
        self._facts = () if worlds.mission.cleans else worlds.minds.memory.facts
        own = (*ROBOT[:5], *(ROBOT[5:] if worlds.mission.cleans else self._facts), *holds)
        robots = [f"robot_{k}_{name}" for k in range(worlds.robots) for name in own]
        items = [f"item_{k}_{name}" for k in range(worlds.garbage.stage.shape[1]) for name in ITEM]
        if worlds.mission.cleans:
            stations = [f"{station}_{name}" for station in station_names(worlds.mission.stations) for name in STATION]
        else:
            kinds = zip(kinds_of(worlds.task.around), worlds.task.around, strict=True)
            stations = [
                f"{kind}_{k}_{name}" for kind, at in kinds for k in range(at.places.shape[1]) for name in STATION
            ]
        self.names = (*robots, *items, *stations, "time", *(("garbage_done",) if worlds.mission.cleans else ()))
        self.final = np.zeros((worlds.worlds, len(self.names)), dtype=np.float32)

    def now(self) -> NDArray[np.float32]:
        """Return the state (W, G) of the worlds as they are."""
        worlds = self._worlds
        things = [self._places(thing.places) for thing in worlds.task.around]
        parts = (self._robots(), self._items(), self._places(worlds.stations), *things, self._course())
        return np.concatenate([part.reshape(worlds.worlds, -1) for part in parts], axis=1).astype(np.float32)

    def keep(self, ended: Ints) -> None:
        """Keep the state of the worlds (K,) whose missions have just ended as the final one."""
        self.final[ended] = self.now()[ended]

    def _places(self, points: Floats) -> Floats:
        ground = self._worlds.floor.ground
        if ground.kind == "open":
            return np.clip((points - ground.centre) / ground.size, -1.0, 1.0)
        places: Floats = 2.0 * points / self._worlds.extent - 1.0
        return places

    def _robots(self) -> Floats:
        """Return the components (R, ...) of the robots."""
        physics, garbage = self._worlds.physics, self._worlds.garbage
        carrying = garbage.cargo != NOTHING
        cargo = (carrying, carrying & (garbage.recycled == 1))
        known = [self._worlds.minds.memory[name].values for name in self._facts]
        own = np.column_stack(
            (
                self._worlds.team.working,
                self._places(physics.positions),
                *unit_vectors(physics.headings),
                *(cargo if self._worlds.mission.cleans else known),
                *(_flags(c.held, len(c.model.options)) for c in self._coordinators),
            )
        )
        own[~physics.present] = 0.0
        return np.asarray(own, dtype=np.float64)

    def _items(self) -> Floats:
        """Return the components (W, M, ...) of the items."""
        garbage = self._worlds.garbage
        stages = [(garbage.stage == stage)[..., None] for stage in (LYING, CARRIED, DONE)]
        items = np.concatenate((*stages, self._places(garbage.positions)), axis=2, dtype=np.float64)
        items[garbage.stage == ABSENT] = 0.0
        return items

    def _course(self) -> Floats:
        """Return the share of the time that has passed, and of the items that are dumped (W, 2)."""
        garbage, progress = self._worlds.garbage, self._progress
        time: Floats = np.minimum(self._worlds.ticks / progress.limits, 1.0)
        if not self._worlds.mission.cleans:
            return time
        return np.column_stack((time, garbage.done / np.maximum(garbage.arrived, 1)))


def _flags(numbers: Ints, count: int) -> Floats:
    """Return `numbers` (R,) as rows of `count` flags, one of which is set."""
    flags: Floats = np.eye(count)[numbers]
    return flags


def station_names(stations: StationsConfig) -> list[str]:
    """Return the names (S,) of stations, which are numbered from the second one of a kind on."""
    numbered = zip(stations.kinds, stations.earlier, strict=True)
    return [STATION_KINDS[kind] + (f"_{earlier + 1}" if earlier else "") for kind, earlier in numbered]
