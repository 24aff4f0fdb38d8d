"""Parts of tasks: things, arrays, and the start of one world."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Final

import numpy as np

from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.world.ground import Ground
from selforg.arrays import READ, Floats
from selforg.declared import fields_of, make_arrays
from selforg.gradients.buffer import SoBuffer

TASK_STREAM: Final = 0xFFFFFFFB
"""Spawn key of the draws of a task at the start of a world; other streams have other keys."""
PLACE_TRIES = 10_000
"""Draws for one place before the placement fails."""


@dataclass(frozen=True)
class Things:
    """Things of one kind, which robots sense as gradients of a channel.

    Attributes:
        channel: name by which mechanisms find the gradients.
        places: (W, M, 2) [m], the same array all the time; see `moves`.
        attraction: +1 or -1.
        diffusion, goal_radius: [m], one or (M,).
        moves: whether the task moves the things during a mission.

    """

    channel: str
    places: Annotated[Floats, "W M 2", READ]
    attraction: int = 1
    diffusion: Annotated[float | Floats, "M", READ] = 1.0
    goal_radius: Annotated[float | Floats, "M", READ] = 0.0
    moves: bool = False

    @property
    def count(self) -> int:
        """Number of things of a world, M."""
        return int(self.places.shape[1])

    def show(self, buffer: SoBuffer, world: int, now: float) -> None:
        """Store the gradients of a world in a buffer whose teams are the worlds."""
        places = self.places[world]
        buffer.store_static(
            np.full(len(places), world),
            self.channel,
            places,
            now,
            attraction=self.attraction,
            diffusion=np.broadcast_to(self.diffusion, len(places)),
            goal_radius=np.broadcast_to(self.goal_radius, len(places)),
        )


def kinds_of(things: Sequence[Things]) -> Sequence[str]:
    """Return the names of kinds of things: their channels, with `_repulsive` where one is there twice."""
    names: list[str] = []
    for thing in things:
        names.append(f"{thing.channel}_repulsive" if thing.channel in names else thing.channel)
    return names


class TaskState:
    """Arrays of all worlds, each with its axes and a mark; zero at each reset. States and copies follow from it.

    Axes are W or R first, then numbers, N, settings of the task or names in `Task.sizes`. `KEPT` arrays go on from one
    tick to the next, `CLOCKED` ones hold times of the clock, `SCRATCH` is overwritten in each tick.

    >>> class Flock(TaskState):
    ...     places: Annotated[Floats, "W sheep 2", KEPT]
    >>> Flock({"W": 3, "sheep": 5}).places.shape
    (3, 5, 2)

    """

    def __init__(self, sizes: Mapping[str, int]) -> None:
        for name, field in fields_of(type(self)).items():
            unknown = [axis for axis in field.axes if axis not in sizes and not axis.isdigit()]
            if unknown or field.axes[:1] not in (("W",), ("R",)):
                expected = f"W or R, then any of {', '.join(sizes)} and numbers"
                raise ConfigurationError(f"{type(self).__name__}.{name}: expected axes {expected}, got {field.axes}")
        make_arrays(self, **sizes)

    def reset(self, world: int, rows: slice) -> None:
        """Set the arrays of a world to zero."""
        for name, field in fields_of(type(self)).items():
            getattr(self, name)[rows if field.axes[0] == "R" else world] = 0


class WorldStart:
    """One world at its start, into which a task puts robots and things.

    Attributes:
        world: number of the world.
        rows: rows of its robots in arrays of all worlds.
        robots: number of robots.
        ground: the ground.
        seed: from which all that is random in the world follows; `rng` is the generator of your draws.
        items: (M, 2) places of items [m] that the start has.
        poses: (robots, 3) x [m], y [m] and heading [rad], once they are put.
        given: whether the robots were placed by whoever began the mission; `put_robots` then changes nothing.

    """

    def __init__(
        self,
        world: int,
        rows: slice,
        ground: Ground,
        seed: np.random.SeedSequence,
        poses: Floats | None = None,
        items: Floats | None = None,
    ) -> None:
        self.world, self.rows, self.ground, self.seed = world, rows, ground, seed
        self.rng = np.random.default_rng(np.random.SeedSequence(seed.entropy, spawn_key=(*seed.spawn_key, TASK_STREAM)))
        self.items = np.zeros((0, 2)) if items is None else items
        self.robots: int = rows.stop - rows.start
        self.given = poses is not None
        self.poses: Floats = np.zeros((self.robots, 3)) if poses is None else poses

    @property
    def places(self) -> Floats:
        """Places (robots, 2) [m] of the robots."""
        return self.poses[:, :2]

    def put_robots(self, places: Floats, headings: Floats | None = None) -> None:
        """Put the robots at places (robots, 2) [m] with headings (robots,) [rad], any unless given."""
        if not self.given:
            turned = self.rng.uniform(-np.pi, np.pi, size=self.robots) if headings is None else headings
            self.poses[:] = np.column_stack((places, turned))

    def scattered(
        self,
        count: int,
        apart: float,
        side: float = 0.0,
        away: float = 0.0,
        *,
        free_of: Floats | None = None,
        gap: float | Floats = 0.0,
    ) -> Floats:
        """Return (count, 2) uniform places [m] at least `apart` [m] from each other, which robots can reach.

        Args:
            count: number of places.
            apart: least distance between places [m].
            side: side of the square in the middle in which they lie; 0: the whole ground [m].
            away: least distance from the middle [m].
            free_of: other places (K, 2) [m] that stay free.
            gap: least distance from these [m], one or one for each.

        Raises:
            ConfigurationError: there is no room for all the places.

        """
        ground, taken = self.ground, np.zeros((0, 2)) if free_of is None else free_of
        sides = ground.size if side == 0.0 else np.full(2, side)
        places = np.empty((count, 2))
        for placed in range(count):
            for _ in range(PLACE_TRIES):
                place = ground.space.wrap(ground.centre + (self.rng.uniform(size=2) - 0.5) * sides)
                if (
                    (ground.distances(place, places[:placed]) >= apart).all()
                    and (ground.distances(place, taken) >= gap).all()
                    and float(ground.distances(place, ground.centre)) >= away
                    and ground.is_free(place)
                ):
                    places[placed] = place
                    break
            else:
                raise ConfigurationError(
                    f"robots.count: expected room for {count} places {apart:g} m apart on {sides[0]:g} m x "
                    f"{sides[1]:g} m, got stuck after {placed} of them"
                )
        return places
