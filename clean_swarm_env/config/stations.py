"""Typed configuration of the stations: where garbage is recycled, and where what is left of it is dumped."""

from collections.abc import Sequence

from clean_swarm_env.config.types import FurtherStations, Point
from selector.documents.fields import Closed, Positive

RECYCLING, DUMP = range(2)
"""Kinds of stations."""


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
