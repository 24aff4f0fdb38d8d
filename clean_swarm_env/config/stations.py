"""The recycling station and the dump: where they are, and how near a robot must come."""

from clean_swarm_env.config.types import Point
from selector.documents.fields import Closed, Positive


class StationsConfig(Closed):
    """The two stations that each item passes."""

    recycling: Point = (2.75, 5.5)
    """Position of the recycling station [m]."""
    dump: Point = (8.25, 5.5)
    """Position of the dump station [m]."""
    reach: Positive = 0.5
    """Distance within which a robot is at a station [m]."""
