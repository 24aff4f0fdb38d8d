"""Typed, closed and frozen configuration of a mission: one sentence and a unit per field.

Every value that is impossible is refused here with the key, what was expected and what was given; unknown keys are
errors. `clean_swarm_env.config_files` reads these models from YAML and adds the name of the file. The defaults are the
settings of the reference experiment (see `configs/missions`), with solid robots.
"""

import math
from typing import Annotated, Literal, Self

from pydantic import BeforeValidator, Field, field_validator, model_validator
from pydantic_core import PydanticCustomError

from selector.documents import Closed, NonNegative, Number, Positive, Share

MAX_COVERED_SHARE = 0.45
"""Largest share of the torus that solid discs may cover [-]: random sequential placement jams at 0.547."""

Count = Annotated[int, Field(strict=True, ge=1)]
Point = tuple[Number, Number]
Pose = tuple[Number, Number, Number]


def impossible(key: str, expected: str, given: object) -> PydanticCustomError:
    """Return the error for a value that only its context makes impossible, at the dotted `key` below the model."""
    message = "expected {expected}, got {given}"
    return PydanticCustomError("impossible", message, {"key": key, "expected": expected, "given": str(given)})


class WorldConfig(Closed):
    """The torus and its physics."""

    width: Positive = 11.0
    """Length of the torus along x [m]."""
    height: Positive = 11.0
    """Length of the torus along y [m]."""
    contacts: Literal["solid", "pass_through"] = "solid"
    """Whether robots bump into each other or drive through each other, as in the paper's simulator."""
    physics_rate: Positive = 20.0
    """Physics steps per second, which is also the sampling rate of collisions [Hz]."""
    control_rate: Positive = 5.0
    """Decisions of every robot per second [Hz]; the physics rate is a whole multiple of it."""

    @model_validator(mode="after")
    def _whole_steps(self) -> Self:
        ratio = self.physics_rate / self.control_rate
        if round(ratio) < 1 or abs(ratio - round(ratio)) > 1e-9:
            expected = f"a rate that divides physics_rate {self.physics_rate:g} Hz into whole steps"
            raise impossible("control_rate", expected, self.control_rate)
        return self

    @property
    def physics_steps_per_tick(self) -> int:
        """Number of physics steps in one control period."""
        return round(self.physics_rate / self.control_rate)


class RobotConfig(Closed):
    """Body, drive and pose gradient of each robot."""

    count: Count = 5
    """Number of robots."""
    radius: Positive = 0.25
    """Radius of the disc [m]."""
    mass: Positive = 1.0
    """Mass of the disc [kg]."""
    max_speed: Positive = 1.0
    """Largest speed along the heading [m/s]."""
    max_turn_rate: Positive = 2.0
    """Largest turn rate [rad/s]."""
    turn_gain: Positive = 2.0
    """Turn rate commanded per radian of heading error [1/s]."""
    turn_in_place_beyond: Annotated[float, Field(strict=True, gt=0.0, le=math.pi)] = 1.0471975511965976
    """Heading error from which a robot turns without driving [rad]."""
    command_timeout: Positive = 1.0
    """Time without a drive command after which a robot stops [s]."""
    pose_goal_radius: NonNegative = 0.5
    """Goal radius of the repulsive gradient that each robot carries [m]."""
    pose_diffusion: NonNegative = 1.0
    """Diffusion of the repulsive gradient that each robot carries [m]."""


class GarbageConfig(Closed):
    """The items and how near a robot must be to see or take one."""

    count: Annotated[int, Field(strict=True, ge=0)] = 10
    """Number of items."""
    diffusion: NonNegative = 1.0
    """Diffusion of an item's attractive gradient [m]."""
    goal_radius: NonNegative = 0.0
    """Goal radius of an item's attractive gradient [m]."""
    view_distance: NonNegative = 1.0
    """Distance added to the reach of an item within which it is seen [m]."""
    at_distance: Positive = 0.55
    """Distance within which a robot is at an item [m]."""
    pick_distance: Positive = 0.6
    """Distance within which the nearest item is taken [m]."""


class StationsConfig(Closed):
    """The two stations that each item passes."""

    recycling: Point = (2.75, 5.5)
    """Position of the recycling station [m]."""
    dump: Point = (8.25, 5.5)
    """Position of the dump station [m]."""
    reach: Positive = 0.5
    """Distance within which a robot is at a station [m]."""


class PatrolConfig(Closed):
    """The pheromones of the patrol and the speed of following them."""

    diffusion: Positive = 1.0
    """Diffusion of a fresh pheromone [m]."""
    evaporation_factor: Share = 0.9
    """Factor on a pheromone's diffusion after each evaporation period [-]."""
    evaporation_period: NonNegative = 30.0
    """Time between two evaporations of a pheromone [s]."""
    min_diffusion: NonNegative = 0.3
    """Diffusion below which a pheromone is gone [m]."""
    aggregation_distance: NonNegative = 0.1
    """Distance within which a new pheromone merges with a stored one [m]."""
    view_distance: NonNegative = 4.0
    """Distance added to the reach of a pheromone within which it is felt [m]."""
    min_speed: NonNegative = 0.5
    """Smallest length of the patrol's movement vector [m/s]."""
    max_speed: Positive = 1.0
    """Largest length of the patrol's movement vector [m/s]."""

    @model_validator(mode="after")
    def _ordered_speeds(self) -> Self:
        if self.min_speed > self.max_speed:
            raise impossible("min_speed", f"a speed up to max_speed {self.max_speed:g} m/s", self.min_speed)
        return self


class WeightsConfig(Closed):
    """Weights of the terms that make up a behaviour's activation step."""

    situation: Number = 1.0
    """Weight of the precondition satisfaction [-]."""
    goal: Number = 1.0
    """Weight of the goals served [-]."""
    conflictor: Number = 1.0
    """Weight of the inhibition by goals and by conflictors that are hindered [-]."""
    predecessor: Number = 1.0
    """Weight of what the predecessors give [-]."""
    successor: Number = 1.0
    """Weight of what the successors give [-]."""
    plan: Number = 1.0
    """Weight of the place on the plan [-]."""


def _planner(given: object) -> object:
    """Read a truth value, which is what YAML makes of a bare `off`, as "built-in" or "off"."""
    return ("built-in" if given else "off") if isinstance(given, bool) else given


class NetworkConfig(Closed):
    """The behaviour network of each robot."""

    robot: Annotated[str, Field(strict=True, min_length=1)] = "cleaning"
    """Name of the robot's document in `configs/robots`."""
    activation_threshold: Positive = 7.0
    """Activation that a behaviour needs to start, at the start of the mission [-]."""
    threshold_decay: Annotated[float, Field(strict=True, gt=0.0, le=1.0)] = 0.8
    """Factor on the threshold when nothing runs, and its divisor when something starts [-]."""
    activation_decay: Share = 0.9
    """Share of a behaviour's activation that stays from one step to the next [-]."""
    max_parallel: Count = 1
    """Number of behaviours of one robot that may run at the same time."""
    planner: Annotated[str, BeforeValidator(_planner), Field(strict=True, min_length=1)] = "built-in"
    """Whose plan adds to the activation of its next behaviours: "built-in", "off", or an engine of unified-planning."""
    transport_full_range: Positive = 1.0
    """Distance to a station from which its linear condition is fully satisfied [m]."""
    weights: WeightsConfig = WeightsConfig()
    """Weights of the terms of the activation step."""


class StartConfiguration(Closed):
    """Where robots and items are when a mission starts."""

    id: str
    """Name of the scenario, unique among those of an experiment."""
    robots: Annotated[tuple[Pose, ...], Field(min_length=1)]
    """(N, 3) x [m], y [m] and heading [rad] of each robot."""
    items: tuple[Point, ...]
    """(M, 2) x [m] and y [m] of each item."""

    @field_validator("id", mode="before")
    @classmethod
    def _numbers_are_names(cls, value: object) -> object:
        return str(value) if isinstance(value, int) and not isinstance(value, bool) else value


class MissionConfig(Closed):
    """One cleaning mission: it ends when all items are dumped or the time is over."""

    name: str = "cleaning"
    """Name of the mission."""
    world: WorldConfig = WorldConfig()
    """The torus and its physics."""
    robots: RobotConfig = RobotConfig()
    """The robots."""
    garbage: GarbageConfig = GarbageConfig()
    """The items."""
    stations: StationsConfig = StationsConfig()
    """The recycling and the dump station."""
    patrol: PatrolConfig = PatrolConfig()
    """The patrol."""
    network: NetworkConfig = NetworkConfig()
    """The behaviour network."""
    time_limit: Positive = 3000.0
    """Simulated time after which a mission ends uncompleted [s]."""
    collision_distances: Annotated[tuple[Positive, ...], Field(min_length=1)] = (0.55, 1.0)
    """Centre distances below which a pair counts as colliding [m]; the first one is the one reported."""
    decision_period: Positive = 1.0
    """Time between two decisions of the selector [s]; a whole multiple of the control period."""
    knowledge: str = "cleaning"
    """Name of the expert knowledge file."""

    @model_validator(mode="after")
    def _possible(self) -> Self:
        world, robots, stations = self.world, self.robots, self.stations
        for name, (x, y) in (("recycling", stations.recycling), ("dump", stations.dump)):
            if not (0.0 <= x <= world.width and 0.0 <= y <= world.height):
                expected = f"a point on the torus {world.width:g} m x {world.height:g} m"
                raise impossible(f"stations.{name}", expected, f"[{x:g}, {y:g}]")
        periods = self.decision_period * world.control_rate
        if round(periods) < 1 or abs(periods - round(periods)) > 1e-9:
            expected = f"a whole multiple of the control period {1.0 / world.control_rate:g} s"
            raise impossible("decision_period", expected, self.decision_period)
        fitting = robots_that_fit(world, robots.radius)
        if world.contacts == "solid" and robots.count > fitting:
            room = f"{world.width:g} m x {world.height:g} m"
            expected = f"at most {fitting} solid robots of radius {robots.radius:g} m on {room}"
            raise impossible("robots.count", expected, robots.count)
        return self


def robots_that_fit(world: WorldConfig, radius: float) -> int:
    """Return how many solid discs of `radius` [m] random sequential placement still finds room for."""
    if min(world.width, world.height) < 4.0 * radius:  # a disc would touch its own image across the seam
        return 0
    return int(MAX_COVERED_SHARE * world.width * world.height / (math.pi * radius**2))
