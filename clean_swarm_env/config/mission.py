"""Typed, closed and frozen configuration of a mission: one sentence and a unit per field.

An impossible value raises an error with the key, the expected and the given value. Unknown keys are errors.
`clean_swarm_env.config.load` reads these models from YAML and adds the name of the file. The defaults are the settings
of the reference experiment (see `configs/missions`), with solid robots.
"""

import sys
from collections.abc import Mapping
from math import ceil
from typing import Annotated, Any, Self

import numpy as np
from pydantic import BeforeValidator, Field, SerializeAsAny, model_validator

from clean_swarm_env.config.delivery import EVERYWHERE, DeliveryConfig
from clean_swarm_env.config.events import MOST_TIMES, Again, Event, Join, SetDelivery, check_team, in_order
from clean_swarm_env.config.free_places import check_place, check_walls, free_ground, robots_that_fit
from clean_swarm_env.config.robots import RobotConfig
from clean_swarm_env.config.tasks import (
    CLEANING,
    TaskSettings,
    find_task,
    settings_from,
    with_task_defaults,
)
from clean_swarm_env.config.types import Length, Point, Pose, Seconds
from clean_swarm_env.config.world import MOST_STEPS, WorldConfig
from selector.documents.errors import impossible
from selector.documents.fields import Closed, DocumentName, Name, NonNegative, Number, Positive
from selector.knowledge import LearnedScores, learned_from
from selector.vocabulary.settings import SettingsSpec
from selforg.arrays import Floats, Ints

COUNTED_GAPS = (0.05, 0.5)
"""Gaps between bodies below which pairs count unless a mission says otherwise [m]: solid ones sink in a little."""
SPARE = 2.0
"""Margin around the places that robots can reach on open land [m]."""
PUSHED = 1.4
"""How many times as fast as its drive a robot can get that others push [-]: 1.38 is the most that was measured."""


class StartConfiguration(Closed):
    """Places of robots and items at the start of a mission."""

    id: Annotated[Name, BeforeValidator(lambda value: str(value) if type(value) is int else value)]
    """Name of the scenario, or its number, unique among those of an experiment."""
    robots: tuple[Pose, ...]
    """(N, 3) x [m], y [m] and heading [rad] of each robot; empty where the task of the mission places them."""
    items: tuple[Point, ...] = ()
    """(M, 2) x [m] and y [m] of each item."""


class NetworkConfig(SettingsSpec):
    """The behaviour network of each robot: its document, its settings and its planner."""

    robot: DocumentName = "cleaning"
    """Name of the robot's document in `configs/robots`."""
    activation_threshold: Positive = 7.0
    """Activation that a behaviour needs to start, at the start of the mission [-]."""
    max_parallel: Annotated[int, Field(strict=True, ge=1, le=1000)] = 1
    """Number of behaviours of one robot that may run at the same time."""
    planner: Name = "built-in"
    """Planner whose plans add activation: "built-in", "off", or an engine of unified-planning."""
    transport_full_range: Positive = 1.0
    """Distance to a station from which its linear condition is fully satisfied [m]."""


OptionScores = dict[str, dict[str, Number]]


class MissionConfig(Closed):
    """One mission: its task, world, robots and time limit."""

    name: Name = "cleaning"
    """Name of the mission."""
    task: Annotated[SerializeAsAny[TaskSettings], BeforeValidator(settings_from)] = Field(
        default=CLEANING, validate_default=True
    )
    """What there is to do: the name of a task, or its name and its settings; the task says what the other keys are
    unless they are given."""
    world: WorldConfig = WorldConfig()
    """The ground and its physics."""
    robots: RobotConfig = RobotConfig()
    """The robots."""
    network: NetworkConfig = NetworkConfig()
    """The behaviour network."""
    delivery: DeliveryConfig = DeliveryConfig()
    """The delivery of messages among the robots."""
    events: Annotated[tuple[Event, ...], Field(max_length=10_000)] = ()
    """The events of the mission."""
    time_limit: Seconds = 3000.0
    """Simulated time after which a mission ends uncompleted, or ends at all if items keep coming [s]."""
    collision_cost: NonNegative = 2.0
    """Price of a collision event at the first distance in the cost of a mission [s]."""
    contact_cost: NonNegative = 0.0
    """Price of each second in which a pair is closer than the first distance, in the cost of a mission [s/s]."""
    collision_distances: Annotated[tuple[Length, ...], Field(max_length=10)] = ()
    """Centre distances below which a pair counts as colliding [m]; the first one is the one reported. Bodies that
    touch, within 0.05 m, and those within 0.5 m, unless given.

    Of robots that differ in size they are those of the first model; others keep the same gap between bodies.
    """
    decision_period: Seconds = 1.0
    """Time between two decisions of the selector [s]; a whole multiple of the control period."""
    knowledge: DocumentName = "cleaning"
    """Name of the expert knowledge file."""
    terms: tuple[Name, ...] = ()
    """Terms of the observation beside the default ones, in environments and in evaluations alike."""
    store: str = ""
    """File of a knowledge store, whose scores of missions of this name the mission begins with; empty: none."""
    learned: LearnedScores = Field(default={})
    """Rewards of options with which the mission begins, besides those in the file and the store."""
    scores: OptionScores = Field(default={})
    """Goal -> option -> score, in place of that of the expert knowledge and of what was learned; options that are not
    named keep theirs."""

    @model_validator(mode="before")
    @classmethod
    def _of_task(cls, given: object) -> object:
        return with_task_defaults(given) if isinstance(given, Mapping) else given

    @model_validator(mode="after")
    def _possible(self) -> Self:
        self._raise_rate()
        check_walls(self.world, self.robots.radius)
        find_task(self.task.name).check(self)
        self._check_times()
        self._check_room()
        return self

    def _raise_rate(self) -> None:
        """Make the physics steps so short that no body gets through a wall or another body in one of them.

        Chipmunk looks at where bodies are, not at their way: the fastest robot, pushed by others, has to go less than
        half of the smallest radius in a step.
        """
        world, models = self.world, self.robots.models
        if world.contacts == "pass_through" and not world.has_walls:
            return
        fastest, smallest = max(model.max_speed for model in models), min(model.radius for model in models)
        steps = ceil(2.0 * PUSHED * fastest / (smallest * world.control_rate) - 1e-9)
        if steps > MOST_STEPS:
            least = 2.0 * PUSHED * fastest / (smallest * MOST_STEPS)
            raise impossible(
                "world.control_rate",
                f"at least {least:.3g} Hz, for {fastest:g} m/s and a radius of {smallest:g} m",
                world.control_rate,
            )
        if steps > world.physics_steps_per_tick:
            self.__dict__["world"] = world.model_copy(update={"physics_rate": steps * world.control_rate})

    def _check_times(self) -> None:
        """Raise the error of the first time that is no number of control periods."""
        world = self.world
        for key, time, least in (
            ("decision_period", self.decision_period, 1),
            ("delivery.delay", self.delivery.delay, 0),
        ):
            periods = time * world.control_rate
            if round(periods) < least or abs(periods - round(periods)) > 1e-9:
                raise impossible(key, f"a whole multiple of the control period {1.0 / world.control_rate:g} s", time)
        together = sum(
            max(self.time_limit - event.at, 0.0) / event.every
            for event in self.events
            if isinstance(event, Again) and event.every > 0.0
        )
        if together > MOST_TIMES:
            raise impossible("events", f"at most {MOST_TIMES} times that they happen together", f"{together:.0f}")
        if self.time_limit * world.control_rate < 1.0:
            raise impossible(
                "time_limit", f"at least one control period, {1.0 / world.control_rate:g} s", self.time_limit
            )

    def _check_room(self) -> None:
        """Raise an error if robots have no room."""
        world, robots = self.world, self.robots
        fitting = robots_that_fit(world, robots.mean_radius, robots.radius)
        room = f"on {world.width:g} m x {world.height:g} m"
        if world.contacts == "solid" and robots.count > fitting:
            expected = f"at most {fitting} solid robots of radius {robots.mean_radius:.3g} m {room}"
            raise impossible("robots.count", expected, robots.count)
        names = [model.model for model in robots.models]
        for place, event in enumerate(self.events):
            if isinstance(event, Join) and event.model and event.model not in names:
                raise impossible(f"events.{place}.model", f"a model of the robots ({', '.join(names)})", event.model)
            for n, (x, y, _) in enumerate(event.places if isinstance(event, Join) else ()):
                check_place(f"events.{place}.places.{n}", (x, y), world, robots.radius)
        check_team(self.events, robots.count, fitting if world.contacts == "solid" else sys.maxsize, room)
        if 0 < robots.capacity < self._robots_needed:
            expected = f"0 or at least {self._robots_needed}, the robots at the start and those that join"
            raise impossible("robots.capacity", expected, robots.capacity)

    def beginning_with(self, learned: Mapping[str, Any]) -> "MissionConfig":
        """Return the mission without a store, and with learned rewards of options, if any, as plain data."""
        known = learned_from(learned, "learned") if learned else self.learned
        return self.model_copy(update={"store": "", "learned": known})

    @property
    def extent(self) -> tuple[float, float]:
        """Width and height of the torus of the physics [m].

        Open land is so wide that no robot can get round it within the mission. A walled field is a quarter of its
        torus, so that the way to any place in it is shorter inside than across a seam.
        """
        world = self.world
        if world.ground == "walled":
            return 2.0 * world.width, 2.0 * world.height
        beyond = 0.0 if world.ground == "torus" else self.time_limit * self.robots.max_speed + SPARE
        return world.width + 2.0 * beyond, world.height + 2.0 * beyond

    def is_free(self, point: Floats) -> bool:
        """Return whether a robot has room at a point (2,) [m], and can drive from there to the rest of the ground."""
        if not self.world.has_walls:
            return True
        corner = 0.5 * (np.array(self.extent) - self.size) if self.world.ground == "open" else 0.0
        return bool(free_ground(self.world, self.robots.radius).has((point - corner)[None])[0])

    @property
    def size(self) -> Floats:
        """Width and height (2,) of the torus or field, or of the part of open land in which robots start [m]."""
        return np.array([self.world.width, self.world.height])

    @property
    def rows(self) -> int:
        """Number of robots of the whole mission for which a world has rows."""
        return self.robots.capacity or self._robots_needed

    @property
    def models(self) -> Ints:
        """The number of the model of each robot (N,) of the whole mission, in `robots.models`.

        First come those at the start, then those that join, then rows that no event needs, of the first model.
        """
        names = [model.model for model in self.robots.models]
        found = [number for number, model in enumerate(self.robots.models) for _ in range(model.count)]
        for _, event in in_order(self.events):
            if isinstance(event, Join):
                found += [names.index(event.model) if event.model else 0] * event.robots
        return np.array((found + [0] * self.rows)[: self.rows], dtype=np.int64)

    @property
    def counted_distances(self) -> tuple[float, ...]:
        """See `collision_distances`."""
        touching = 2.0 * self.robots.models[0].radius
        return self.collision_distances or tuple(touching + gap for gap in COUNTED_GAPS)

    def of_each(self, key: str) -> Floats:
        """Return a setting of each robot (N,) of the whole mission; see `RobotModel`."""
        return np.array([getattr(model, key) for model in self.robots.models], dtype=np.float64)[self.models]

    @property
    def _robots_needed(self) -> int:
        return self.robots.count + sum(event.robots for event in self.events if isinstance(event, Join))

    @property
    def slowest(self) -> float:
        """Largest speed of the slowest robots, in the slowest zone, as a share of 1 m/s; at most 1 [-].

        Distances at which pheromones merge are made for 1 m/s; where robots are slower they are shorter by this factor.
        Else a robot whose step is shorter than the distance drags one pheromone along and leaves no trail.
        """
        zones = min((zone.speed for zone in self.world.zones), default=1.0)
        return min(1.0, zones * min(model.max_speed for model in self.robots.models))

    @property
    def delay_ticks(self) -> int:
        """Control periods from sending a message to its arrival."""
        return round(self.delivery.delay * self.world.control_rate)

    @property
    def own_contents(self) -> bool:
        """Whether each robot stores its own messages, because delivery is not ideal or may change."""
        changes = any(isinstance(event, SetDelivery) for event in self.events)
        near = any(model.message_range < EVERYWHERE for model in self.robots.models)
        silent = self.world.blocks("messages") or any(zone.loss > 0.0 for zone in self.world.zones)
        return self.delivery.own_contents or not self.delivery.ideal or changes or near or silent
