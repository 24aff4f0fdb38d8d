"""The base class of scenes: an arena in which robots have to reach a goal, and the measures of success."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal, final

import numpy as np

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.scenes.arena import CONTROL_PERIOD, PLACES, THINGS, Arena, Body
from clean_swarm_env.scenes.baselines import Controller, Wander
from clean_swarm_env.scenes.ground import Ground, GroundKind
from clean_swarm_env.scenes.placing import Taken, any_headings, scattered
from selforg.arrays import Floats
from selforg.commands import Commands
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.delivery import Delivery
from selforg.gradients.settings import BufferSettings
from selforg.registry import Registry, UnknownNameError

AROUND_SETTINGS = BufferSettings(aggregation={"DEFAULT": "new"}, aggregation_distance=0.0)
"""Settings of the buffer of all but pheromones: gradients at one place are one thing."""
TRAIL_SETTINGS = BufferSettings(view_distance=4.0, aggregation_distance=0.1, min_diffusion=0.3)
"""Settings of the buffer of pheromones: those of the cleaning mission."""


@dataclass(frozen=True)
class Measure:
    """A figure of success in reaching a goal.

    Attributes:
        name: name of the figure.
        unit: "-" for a pure number.
        better: whether lower or higher values are better.
        target: value to reach in the scene's own setting, stated before anything was run.
        reason: reason for the target.
        guard: whether the figure is a price: it has to meet its target, but need not beat the baseline.

    """

    name: str
    unit: str
    better: Literal["lower", "higher"]
    target: float
    reason: str
    guard: bool = False

    def met(self, value: float) -> bool:
        """Return whether a value reaches the target."""
        return value <= self.target if self.better == "lower" else value >= self.target


@dataclass(frozen=True)
class Setting:
    """The user's choices: number of robots, seconds to run and the kind of ground."""

    robots: int
    seconds: float
    ground: GroundKind

    @property
    def ticks(self) -> int:
        """Control periods to run."""
        return max(round(self.seconds / CONTROL_PERIOD), 1)


@dataclass(frozen=True)
class Gradients:
    """Static gradients of one channel: places (W, M, 2) [m]; diffusion and goal radius [m], one or (M,)."""

    channel: str
    places: Floats
    attraction: int = 1
    diffusion: float | Floats = 1.0
    goal_radius: float | Floats = 0.0

    def store(self, buffer: SoBuffer) -> None:
        """Store the gradients in a buffer whose teams are the worlds."""
        worlds, count, _ = self.places.shape
        buffer.store_static(
            np.repeat(np.arange(worlds), count),
            self.channel,
            self.places.reshape(-1, 2),
            0.0,
            attraction=self.attraction,
            diffusion=np.tile(np.broadcast_to(self.diffusion, count), worlds),
            goal_radius=np.tile(np.broadcast_to(self.goal_radius, count), worlds),
        )


@dataclass(frozen=True)
class Run:
    """The results of one run.

    Attributes:
        values: measure -> (W,).
        tracks: (T + 1, R, 2) [m] places of all robots at the start and after each control period.

    """

    values: Mapping[str, Floats]
    tracks: Floats


class Scene(ABC):
    """W worlds in which robots have to reach one goal.

    The class declares the goal, the measures and the scene's own setting. An object serves one run: `run`, or `start`
    and `advance`. Subclasses implement `_result`, and those of the other hooks that they need.

    Attributes:
        chosen: the setting of this run.
        ground, arena: the ground, and the robots on it.
        around: gradients that are there from the start on.
        known: knowledge of the robots at the start: name -> (R,) or one value.
        served: whether a mechanism serves the goal in this run; otherwise the baseline runs.
        controller: the mechanism or the baseline, once the run has begun.

    """

    goal: ClassVar[str]
    story: ClassVar[str]  # one sentence: the robots, their place and their task
    measures: ClassVar[tuple[Measure, ...]]
    baseline: ClassVar[str] = "random walk, a new direction every 2 s"  # what the mechanism must beat
    setting: ClassVar[Setting]
    side: ClassVar[float]  # [m] of the field in which all start
    torus_side: ClassVar[float] = 0.0  # [m] of the torus, where the field alone would be too small for one
    fewest: ClassVar[int] = 1  # robots with which the measures have a meaning
    body: ClassVar[Body] = Body()
    apart: ClassVar[float] = 1.0  # [m] least distance of two robots at the start,
    away: ClassVar[float] = 0.0  # and of a robot from the middle of the field
    start_side: ClassVar[float | None] = None  # [m] of the square in the middle in which robots start, if not the field

    @final
    def __init__(self, setting: Setting, seeds: Sequence[int]) -> None:
        if setting.robots < self.fewest:
            raise ConfigurationError(f"--robots: {self.goal} expects at least {self.fewest}, got {setting.robots}")
        self.chosen = setting
        self.ground = Ground(setting.ground, self.side, setting.seconds * self.body.max_speed, self.torus_side)
        try:
            self.arena = Arena(self.ground, setting.robots, seeds, self.body)
        except ValueError as error:
            raise ConfigurationError(f"--robots: {error}") from error
        for world in range(self.arena.worlds):
            self.arena.physics.place(world, *self._place(self.arena.chance(world, PLACES)))
        self._prepare([self.arena.chance(world, THINGS) for world in range(self.arena.worlds)])
        self.around = self._around()
        self.known = self._known()
        self.served = False

    @final
    def run(self, make: Callable[[Scene], Controller] | None = None) -> Run:
        """Run to the end with the controller that `make` returns for this scene, or with the baseline."""
        self.start(make)
        tracks = [self.arena.positions.copy()]
        while not self.over:
            self.advance()
            tracks.append(self.arena.positions.copy())
        return Run(self.measured(), np.stack(tracks))

    @final
    def start(self, make: Callable[[Scene], Controller] | None = None) -> None:
        """Give the robots the controller that `make` returns for this scene, or the baseline."""
        self.served = make is not None
        self.controller = self._baseline() if make is None else make(self)
        self._commanding = self._with_errand(self.controller)

    @final
    def advance(self, change: Callable[[Commands], None] | None = None) -> None:
        """Run one control period; `change` may write other commands over those of the controller."""
        self.arena.announce()
        commands = self._commanding.command()
        if change is not None:
            change(commands)
        self.arena.move(commands)
        self._look()

    @property
    def over(self) -> bool:
        """Whether the time of the run has passed."""
        return self.arena.ticks >= self.chosen.ticks

    @final
    def measured(self) -> Mapping[str, Floats]:
        """Return the value (W,) of each measure as it stands; at the end it is the result of the run."""
        return self._result()

    def buffers(self) -> dict[str, SoBuffer]:
        """Return new buffers, by the names that configurations use, with the gradients of `around`.

        In `own_pheromones` each robot finds only its own pheromones.
        """
        space, poses = self.ground.space, self.arena.poses
        gradients = SoBuffer(AROUND_SETTINGS, space, poses)
        for lying in self.around:
            lying.store(gradients)
        own = SoBuffer(TRAIL_SETTINGS, space, poses, Delivery(reach=0.0))
        return {"gradients": gradients, "pheromones": SoBuffer(TRAIL_SETTINGS, space, poses), "own_pheromones": own}

    @property
    def positions(self) -> Floats:
        """Positions of the robots (W, N, 2) [m]."""
        return self.arena.by_world(self.arena.positions)

    @property
    def headings(self) -> Floats:
        """Headings of the robots (W, N) [rad]."""
        return self.arena.by_world(self.arena.headings)

    def _place(self, rng: np.random.Generator) -> tuple[Floats, Floats]:
        """Return the start of the robots of one world: positions (N, 2) [m] and headings (N,) [rad]."""
        clear = Taken(self.ground.centre[None], self.away)
        places = scattered(rng, self.chosen.robots, self.ground, self.apart, self.start_side, clear)
        return places, any_headings(rng, self.chosen.robots)

    def _baseline(self) -> Controller:
        """Return the baseline."""
        return Wander(self.arena)

    @abstractmethod
    def _result(self) -> Mapping[str, Floats]:
        """Return the value (W,) of each measure by its name: finite at any time, the result of the run at the end."""

    def _prepare(self, chances: list[np.random.Generator]) -> None:  # noqa: B027  (many scenes need nothing)
        """Prepare gradients and measures, with one generator for each world; robots are in place."""

    def _around(self) -> tuple[Gradients, ...]:
        """Return the gradients that are there from the start on; called after `_prepare`."""
        return ()

    def _known(self) -> Mapping[str, Floats | float]:
        """Return the knowledge of the robots at the start; called after `_prepare`."""
        return {}

    def _with_errand(self, controller: Controller) -> Controller:
        """Return the controller of the robots: the mechanism or the baseline, combined with an errand if any."""
        return controller

    def _look(self) -> None:  # noqa: B027  (some scenes look at the end only)
        """Update the measures after each control period."""


SCENES: Registry[Scene] = Registry("goal", lambda scene: scene.goal)
"""Scenes by their goals."""


def goals() -> tuple[str, ...]:
    """Return the goals that have a scene, sorted."""
    return SCENES.names()


def find(goal: str) -> type[Scene]:
    """Return the scene of a goal; an unknown one raises ConfigurationError and lists the known ones."""
    try:
        return SCENES.find(goal)
    except UnknownNameError as error:
        raise ConfigurationError(str(error)) from error
