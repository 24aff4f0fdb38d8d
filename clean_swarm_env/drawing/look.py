"""How things look in every picture of a world: files, arrays, windows, videos, and pages of replay and play.

Colours, sizes, letters and words are defined here only; pages get them as JSON. The first seven colours of options are
those of Okabe and Ito (2008), which colour-blind readers can tell apart.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

OPTION_COLOURS: Final = (
    "#0072B2", "#E69F00", "#009E73", "#CC79A7", "#D55E00", "#56B4E9", "#F0E442", "#8C6BB1", "#999999", "#882255",
)  # fmt: skip


@dataclass(frozen=True)
class Sign:
    """How a thing looks in the world and in the legend."""

    word: str
    colour: str
    shape: str = "disc"
    """`disc`, `diamond` or `square`."""
    half: float = 0.25
    """Half of its height [m]."""
    letter: str = ""
    opacity: float = 1.0


@dataclass(frozen=True)
class Appearance:
    """What pictures and pages have in common; the parts of a robot are measured in its radius."""

    options: tuple[str, ...] = OPTION_COLOURS
    """Colours of robots by the option that they hold; an eleventh option has the first colour again."""
    ink: str = "#2b2b2b"
    paper: str = "#fbfaf7"
    edge: str = "#9a958a"
    attracts: str = "#009E73"
    repels: str = "#D55E00"
    contact: str = "#D00000"
    area_opacity: float = 0.2
    """Opacity of stations, and of things that attract or repel."""
    least_area: float = 0.2
    """Least radius of a thing that attracts or repels [m]."""
    front_angle: float = 0.45
    """Half of the angle of a robot's white front [rad]."""
    front_length: float = 0.9
    cargo_behind: float = 0.4
    """From the middle of a robot to that of its cargo."""
    cargo_half: float = 0.42
    """Half of the height of a carried item; leftovers are smaller by as much as on the floor."""
    letter_size: float = 11.0
    """Size of the robots' numbers and of the legend [pixels]."""
    most_numbered: int = 60
    """Robots up to which their numbers are shown."""
    least_numbered: float = 8.0
    """Radius from which a robot is large enough for a number [pixels]."""
    failed: Sign = Sign("failed robot", "#77736b")
    item: Sign = Sign("item", "#E69F00", "diamond", 0.11)
    leftovers: Sign = Sign("leftovers of an item", "#E69F00", "diamond", 0.07)
    stations: tuple[Sign, ...] = (
        Sign("recycling station", "#009E73", "square", 0.16, "R"),
        Sign("dump station", "#8C6BB1", "square", 0.16, "D"),
    )
    """By their kinds."""
    pheromones: Sign = Sign("pheromones", "#56B4E9", opacity=0.66)
    """In their middle, where they have just been left."""


LOOK: Final = Appearance()


def legend(options: Sequence[str], cleans: bool) -> list[Sign]:
    """Return the entries of a legend: the options, and what else there is to see."""
    held = [Sign(name, OPTION_COLOURS[k % len(OPTION_COLOURS)]) for k, name in enumerate(options)]
    return [*held, LOOK.failed, *((LOOK.item, LOOK.leftovers, *LOOK.stations, LOOK.pheromones) if cleans else ())]
