"""A gradient (the paper's SoMessage) as one object, and the checks of its fields."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

FARTHEST = 1e9  # [m]: beyond, doubles no longer resolve a micrometre
LATEST = 1e12  # [s]
SHORTEST = 1e-6  # [s]: shorter periods would need more evaporations than can be counted


@dataclass(frozen=True)
class Gradient:
    """What one robot tells the others about one place.

    Attributes:
        channel: what the gradient is for; not a coordinate frame.
        position: (D,) [m].
        source: who spread it: the row of a robot, or any name.
        heading: (D,) direction, empty or zero if it has none.
        attraction: +1 attractive, -1 repulsive, 0 neutral.
        diffusion: radius over which it weakens [m], may be infinite.
        goal_radius: radius of its goal area [m].
        evaporation_factor: share of the diffusion that remains after each period [-], in [0, 1]; 1: never evaporates.
        evaporation_period: [s], 0 with a factor below 1: the diffusion is gone at once.
        stamp: when it was spread [s].
        clock: time up to which it has evaporated already [s]; None: its stamp.
        moving: carried by a robot (the newest per source counts) or deposited.
        payload: anything else to tell.

    """

    channel: str
    position: tuple[float, ...]
    source: int | str = ""
    heading: tuple[float, ...] = ()
    attraction: int = 1
    diffusion: float = 1.0
    goal_radius: float = 0.0
    evaporation_factor: float = 1.0
    evaporation_period: float = 0.0
    stamp: float = 0.0
    clock: float | None = None
    moving: bool = False
    payload: Mapping[str, Any] = field(default_factory=dict)

    @property
    def reach(self) -> float:
        """Radius [m] at which it ends: diffusion + goal radius."""
        return self.diffusion + self.goal_radius


def check_position(position: npt.NDArray[np.float64]) -> None:
    """Raise ValueError unless all coordinates (..., D) [m] are possible."""
    require("position", position, np.abs(position) <= FARTHEST, f"finite, at most {FARTHEST:g} m")


def check_fields(
    attraction: npt.ArrayLike,
    diffusion: npt.ArrayLike,
    goal_radius: npt.ArrayLike,
    evaporation_factor: npt.ArrayLike,
    evaporation_period: npt.ArrayLike,
    stamp: npt.ArrayLike,
) -> None:
    """Raise ValueError naming the first field with an impossible value; each a number or an array of them."""
    sign = numbers("attraction", attraction)
    require("attraction", sign, (sign == -1) | (sign == 0) | (sign == 1), "-1, 0 or 1")
    radius = numbers("diffusion", diffusion)
    fits = (radius >= 0) & ((radius <= FARTHEST) | np.isinf(radius))
    require("diffusion", radius, fits, f"at least 0 and at most {FARTHEST:g} m, or infinite")
    radius = numbers("goal_radius", goal_radius)
    require("goal_radius", radius, (radius >= 0) & (radius <= FARTHEST), f"at least 0 and at most {FARTHEST:g} m")
    factor = numbers("evaporation_factor", evaporation_factor)
    require("evaporation_factor", factor, (factor >= 0) & (factor <= 1), "in [0, 1]")
    period = numbers("evaporation_period", evaporation_period)
    fits = (period == 0) | ((period >= SHORTEST) & (period < np.inf))
    require("evaporation_period", period, fits, f"0 or at least {SHORTEST:g} s")
    clock = numbers("stamp", stamp)
    require("stamp", clock, np.abs(clock) <= LATEST, f"finite, at most {LATEST:g} s")


def numbers(name: str, value: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Return `value` as float64; raises ValueError for field `name` if it is not a number or an array of them."""
    try:
        return np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"gradient: {name} must be a number, got {value!r}") from None


def require(name: str, value: npt.NDArray[Any], fits: npt.NDArray[np.bool_] | np.bool_, expected: str) -> None:
    """Raise ValueError for field `name` unless all of `fits` hold for `value`."""
    if not np.all(fits):
        wrong = value[~fits].flat[0] if value.ndim else value[()]
        raise ValueError(f"gradient: {name} must be {expected}, got {wrong}")


def check_places(caller: str, positions: npt.ArrayLike, dim: int) -> npt.NDArray[np.float64]:
    """Return `positions` as (M, D), or raise ValueError, which begins with the `caller`."""
    places = np.atleast_2d(np.asarray(positions, dtype=np.float64))
    if places.shape[1:] != (dim,):
        raise ValueError(f"{caller}: positions must be (M, {dim}), got {np.shape(positions)}")
    check_position(places)
    return places


def check_gradient(gradient: Gradient, dim: int) -> None:
    """Raise ValueError naming the first impossible field of a gradient in a space of `dim` dimensions."""
    if not isinstance(gradient.channel, str):
        raise ValueError(f"gradient: channel must be a name, got {gradient.channel!r}")
    if not isinstance(gradient.payload, Mapping):
        raise ValueError(f"gradient: payload must be a mapping, got {gradient.payload!r}")
    place, heading = numbers("position", gradient.position), numbers("heading", gradient.heading)
    for name, vector, shapes in (("position", place, ((dim,),)), ("heading", heading, ((dim,), (0,)))):
        if vector.shape not in shapes:
            raise ValueError(f"gradient: {name} must have {dim} components, got {getattr(gradient, name)!r}")
    check_position(place)
    g = gradient
    check_fields(g.attraction, g.diffusion, g.goal_radius, g.evaporation_factor, g.evaporation_period, g.stamp)
    require("heading", heading, np.abs(heading) <= FARTHEST, "finite")
    if gradient.clock is not None:
        clock = numbers("clock", gradient.clock)
        require("clock", clock, np.abs(clock) <= LATEST, f"finite, at most {LATEST:g} s")
