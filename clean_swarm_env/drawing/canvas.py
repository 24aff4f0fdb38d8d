"""What a picture of a world shows: robots with load and option, things and the pheromone trail, on the torus.

Shapes: N robots, M pheromones, K things with one sign.
"""

from dataclasses import dataclass, field, replace
from itertools import product
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from selforg.arrays import Flags, Floats, Ints
from selforg.compiler.decorators import kernel

Pixels = NDArray[np.uint8]
"""A picture (H, W, 3)."""
NOTHING: Final = -1  # in `Canvas.load`
TRAIL_PITCH: Final = 0.1  # [m] of the raster on which the trail is drawn
MOST_TRAIL_CELLS: Final = 1000  # on a side of this raster
LEAST_DIFFUSION: Final = 1e-9  # [m] where there are no pheromones
FRAMES_PER_SECOND: Final = 20
"""Pictures of a video for each second of the mission."""
Zone = tuple[str, float, float, float, float]
"""A rectangle of the ground: its name, lower left and upper right corner [m]."""
FARTHEST_STEP: Final = 1.0  # [m] from picture to picture; beyond it a robot was put elsewhere


class Area(NamedTuple):
    """A place that means something to robots: its name, middle and radius [m], and whether it repels them."""

    name: str
    x: float
    y: float
    radius: float
    repels: bool = False


class SignedThings(NamedTuple):
    """Things with one sign: its name, their places (K, 2) [m], and the radius of the area around each [m]."""

    sign: str
    places: Floats
    radius: float = 0.0


@dataclass(frozen=True)
class Canvas:
    """The data of a picture."""

    positions: Floats  # (N, 2) [m] of the robots
    headings: Floats  # (N,) [rad]
    width: float = 11.0  # [m]
    height: float = 11.0  # [m]
    closed: bool = True  # whether opposite sides are one
    time: float = 0.0  # [s] since the start
    state: str = ""  # what there is to say of this moment
    radius: float | Floats = 0.25  # [m] of all robots, or (N,) of each
    models: Ints | None = None  # (N,) numbers of the robots' models; None: all are alike
    model_names: tuple[str, ...] = ()  # of these models
    loads: tuple[str, ...] = ()  # names of the signs of what robots carry
    load: Ints | None = None  # (N,) which of them each robot carries, NOTHING for none; None: none carries anything
    numbers: Ints | None = None  # (N,) numbers of the robots; None: 0, 1 and so on
    working: Flags | None = None  # (N,) whether the robot is at work; None: all are
    options: tuple[str, ...] = ()  # names of the options of a goal
    held: Ints | None = None  # (N,) which of them serves the goal in each robot; None: the first
    signs: tuple[SignedThings, ...] = ()  # of things
    areas: tuple[Area, ...] = ()  # what else lies in the world
    zones: tuple[Zone, ...] = ()  # in which messages are lost or robots are slow
    walls: Floats = field(default_factory=lambda: np.zeros((0, 4)))  # (K, 4) x, y of either end [m]
    pheromones: Floats = field(default_factory=lambda: np.zeros((0, 2)))  # (M, 2) [m]
    pheromone_diffusions: Floats = field(default_factory=lambda: np.zeros(0))  # (M,) [m]


def between(first: Canvas, second: Canvas, share: float) -> Canvas:
    """Return the canvas at a share of the time from one moment to another: robots move, all else is as it was first."""
    if len(first.positions) != len(second.positions) or first.width != second.width:
        return first
    size = np.array([first.width, first.height])
    moved, turned = _shorter(second.positions - first.positions, size), second.headings - first.headings
    moved *= (np.hypot(*moved.T) < FARTHEST_STEP)[:, None]
    return replace(
        first,
        positions=(first.positions + share * moved) % size,
        headings=first.headings + share * _shorter(turned, np.array(2.0 * np.pi)),
        time=first.time + share * (second.time - first.time),
    )


def _shorter(offsets: Floats, size: Floats) -> Floats:
    """Return offsets on a circle the shorter way."""
    return offsets - size * np.round(offsets / size)


def appearances(canvas: Canvas, places: Floats, extent: float) -> tuple[Ints, Floats]:
    """Return where things of half size `extent` [m] at places (K, 2) [m] show on the map: several times at a seam.

    Number of each thing (M,), and where it shows (M, 2) [m].
    """
    size = np.array([canvas.width, canvas.height])
    moved = places[:, None] + size * np.array(list(product((-1, 0, 1), repeat=2)))
    shown = ((moved > -extent) & (moved < size + extent)).all(axis=2)
    if not canvas.closed:
        shown &= (moved == places[:, None]).all(axis=2)
    return np.nonzero(shown)[0], moved[shown]


def trail_strength(canvas: Canvas) -> Floats:
    """Return the strength of the pheromones on a raster (rows upwards, columns to the right) of TRAIL_PITCH [m].

    In each cell the strongest pheromone counts: its diffusion radius without the distance, as a share of the largest
    diffusion radius.
    """
    lines, columns = (
        min(max(round(size / TRAIL_PITCH), 1), MOST_TRAIL_CELLS) for size in (canvas.height, canvas.width)
    )
    strength = np.zeros((lines, columns))
    places = np.ascontiguousarray(canvas.pheromones, dtype=np.float64)
    diffusions = np.ascontiguousarray(canvas.pheromone_diffusions, dtype=np.float64)
    lay_trail(places, diffusions, canvas.width, canvas.height, canvas.closed, strength)
    strength /= diffusions.max(initial=LEAST_DIFFUSION)
    return strength


@kernel
def lay_trail(places: Floats, diffusions: Floats, width: float, height: float, closed: bool, strength: Floats) -> None:
    """Raise cells (rows, columns) to how far [m] each is inside a pheromone: `places` (M, 2) [m]; `closed`: a torus."""
    lines, columns = strength.shape
    across, up = width / columns, height / lines
    for k in range(len(diffusions)):
        if diffusions[k] <= 0.0:
            continue
        right = min(int(np.ceil(diffusions[k] / across)), columns // 2)
        above = min(int(np.ceil(diffusions[k] / up)), lines // 2)
        column, line = int(np.floor(places[k, 0] / across)), int(np.floor(places[k, 1] / up))
        for i in range(line - above, line + above + 1):
            if not closed and not 0 <= i < lines:
                continue
            dy = (i + 0.5) * up - places[k, 1]
            row = strength[i % lines]
            for j in range(column - right, column + right + 1):
                if not closed and not 0 <= j < columns:
                    continue
                dx = (j + 0.5) * across - places[k, 0]
                felt = diffusions[k] - np.sqrt(dx * dx + dy * dy)
                cell = j - columns if j >= columns else (j + columns if j < 0 else j)
                if felt > row[cell]:
                    row[cell] = felt
