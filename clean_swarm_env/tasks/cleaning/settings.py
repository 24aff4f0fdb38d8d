"""Settings of cleaning, the keys of `task:`: garbage, stations, the patrol, and the consequences of collisions."""

from collections.abc import Sequence
from typing import Annotated, Self

from pydantic import Field, model_validator

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.tasks import ItemsConfig, TaskSettings
from clean_swarm_env.config.types import Point, Wait
from selector.documents.errors import impossible
from selector.documents.fields import Closed, Flag, NonNegative, Positive, Share

RECYCLING, DUMP = range(2)
"""Kinds of stations."""
FurtherStations = Annotated[tuple[Point, ...], Field(max_length=100)]
"""Places of stations beside the first one of their kind [m]; a robot looks at all of them."""


class StationsConfig(Closed):
    """The stations; each item passes one of either kind."""

    recycling: Point = (2.75, 5.5)
    """Position of the recycling station [m]."""
    dump: Point = (8.25, 5.5)
    """Position of the dump station [m]."""
    further_recycling: FurtherStations = ()
    """Positions of further recycling stations [m]."""
    further_dumps: FurtherStations = ()
    """Positions of further dump stations [m]."""
    reach: Positive = 0.5
    """Distance within which a robot is at a station [m]."""

    @property
    def places(self) -> tuple[Point, ...]:
        """Positions of all S stations [m]: the first one of either kind, then the further ones."""
        return (self.recycling, self.dump, *self.further_recycling, *self.further_dumps)

    @property
    def kinds(self) -> tuple[int, ...]:
        """Kinds of all S stations, in the order of `places`."""
        further = (RECYCLING,) * len(self.further_recycling) + (DUMP,) * len(self.further_dumps)
        return (RECYCLING, DUMP, *further)

    @property
    def earlier(self) -> tuple[int, ...]:
        """How many stations of the same kind come before each of the S stations."""
        return tuple(self.kinds[:number].count(kind) for number, kind in enumerate(self.kinds))

    def at(self, places: Sequence[Point]) -> "StationsConfig":
        """Return the same stations at other `places` (S,) [m]."""
        dumps = 2 + len(self.further_recycling)
        further = {"further_recycling": tuple(places[2:dumps]), "further_dumps": tuple(places[dumps:])}
        return self.model_copy(update={"recycling": places[0], "dump": places[1], **further})


class GarbageConfig(ItemsConfig):
    """The items and how near a robot must be to see or take one."""

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
    found_again: Wait = 60.0
    """Time after which robots that carry nothing find an item once more, so that others hear of it again [s]."""


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
    """Distance within which a new pheromone merges with a stored one; shorter in proportion where the slowest robots
    have less than 1 m/s in the slowest zone [m]."""
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


class ConsequencesConfig(Closed):
    """Consequences of a collision event for the robots at work that take part; none unless set."""

    harmless: Flag = False
    """Whether collisions have none of these consequences and cost nothing; missions of one batch may differ in it."""

    stop: Wait = 0.0
    """Time for which a robot that collides stops, decides nothing and handles no cargo; 0: it does not stop [s]."""
    back_off: Wait = 0.0
    """Time for which it then drives off at half its speed, away from the nearest robot that it met [s]."""
    drop: Flag = False
    """Whether a robot that collides loses its cargo, which then lies where the robot is."""


class CleaningSettings(TaskSettings):
    """Settings of cleaning."""

    garbage: GarbageConfig = GarbageConfig()
    """The items."""
    stations: StationsConfig = StationsConfig()
    """The recycling and the dump stations."""
    patrol: PatrolConfig = PatrolConfig()
    """The patrol."""
    consequences: ConsequencesConfig = ConsequencesConfig()
    """The consequences of collisions."""


def settings_of(mission: MissionConfig) -> CleaningSettings:
    """Return the settings of a mission of cleaning."""
    assert isinstance(mission.task, CleaningSettings), mission.task.name
    return mission.task
