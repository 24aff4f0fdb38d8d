"""Writing: `Gradient` objects as rows of tables; the other direction is `selforg.gradients.reading`."""

from selforg.arrays import Floats, Ints
from selforg.gradients.gradient import Gradient, padded
from selforg.gradients.names import Codes
from selforg.gradients.store.columns import (
    CLOCK,
    DIFFUSION,
    FACTOR,
    FAR,
    GOAL,
    HX,
    PERIOD,
    STAMP,
    TAG_KEY,
    TAG_MOVING,
    TAG_SIGN,
    VALUE,
    X,
)
from selforg.space import Space


def write_gradient(gradient: Gradient, space: Space, keys: Codes, messages: Floats, tags: Ints) -> None:
    """Fill all `messages` (M, MESSAGE_COLUMNS) and `tags` (M, TAG_COLUMNS) with one checked gradient."""
    g, dim = gradient, space.dim
    place = padded(g.position, dim, "position")
    messages[:, X : X + dim] = space.wrap(place[:dim])
    messages[:, FAR + HX : FAR + HX + 3] = padded(g.heading, dim, "heading")
    messages[:, DIFFUSION], messages[:, GOAL] = g.diffusion, g.goal_radius
    messages[:, FAR + FACTOR], messages[:, FAR + PERIOD] = g.evaporation_factor, g.evaporation_period
    messages[:, FAR + STAMP], messages[:, FAR + CLOCK] = g.stamp, g.stamp if g.clock is None else g.clock
    tags[:, TAG_SIGN], tags[:, TAG_MOVING] = g.attraction, g.moving
    for key, value in g.payload.items():
        if type(value) in (int, float) and abs(value) < float("inf"):
            # the first number travels in the table, where compiled code sees it
            messages[:, FAR + VALUE], tags[:, TAG_KEY] = value, keys.code(str(key))
            break
