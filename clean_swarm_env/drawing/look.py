"""How things look in every picture of a world: files, arrays, windows, videos, and pages of replay and play.

Colours, sizes, letters and words are defined here only; pages get them as JSON. The colours of options are those of
Okabe and Ito (2008) and of Tol (2021), and a violet that is seen on dark ground, too. Colour-blind readers can tell
them apart; none is that of garbage, of a contact or of a robot that has failed.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from clean_swarm_env.world.parts.shown import SIGNS

OPTION_COLOURS: Final = (
    "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#882255", "#56B4E9", "#999933", "#5A3FFF", "#8C6BB1", "#44AA99",
)  # fmt: skip


@dataclass(frozen=True)
class Sign:
    """How a thing looks in the world and in the legend."""

    word: str
    colour: str
    shape: str = "disc"
    """`disc`, `diamond` or `square`; of a page's layers also `ring`, `stroke` or `arrow`."""
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
    contact: str = "#D00000"
    least_area: float = 0.2
    """Least radius of a thing that attracts or repels [m]."""
    front_angle: float = 0.45
    """Half of the angle of a robot's white front [rad]."""
    front_length: float = 0.9
    cargo_behind: float = 0.4
    """From the middle of a robot to that of its cargo."""
    cargo_half: float = 0.42
    """Half of the height of a carried item; leftovers are smaller by as much as on the floor."""
    marks: tuple[str, ...] = ("", "square", "diamond", "disc")
    """White shapes in the middle of robots by their model, where there are several; a fifth has none again."""
    mark_half: float = 0.36
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
    zone: Sign = Sign("zone of lost messages or slow ground", "#999933", "square", 0.16, opacity=0.15)
    wall: Sign = Sign("wall", "#2b2b2b", "stroke")
    wall_width: float = 3.0
    """Width of walls [pixels]."""
    areas: tuple[Sign, ...] = (
        Sign("attracts robots", "#009E73", opacity=0.2),
        Sign("repels robots", "#D55E00", opacity=0.2),
    )
    """Things of tasks other than cleaning; stations have their opacity, too."""
    layers: tuple[tuple[str, Sign], ...] = (
        ("reach", Sign("gradients", "#D55E00", opacity=0.25)),
        ("view", Sign("view", "#0072B2", "ring")),
        ("seen", Sign("who sees whom", "#0072B2", "stroke")),
        ("paths", Sign("paths of 20 s", "#9a958a", "stroke")),
        ("contacts", Sign("contacts", "#D00000", "ring")),
        ("command", Sign("command", "#2b2b2b", "arrow")),
        ("added", Sign("what the mechanism adds", "#D55E00", "arrow")),
        ("target", Sign("way to the target", "#009E73", "arrow")),
        ("causes", Sign("neighbours that count", "#D00000", "stroke")),
    )
    """Layers of pages that have no sign of their own above: name and sign."""


LOOK: Final = Appearance()
SIGN_OF: Final = dict(zip(SIGNS, (LOOK.item, LOOK.leftovers, *LOOK.stations), strict=True))
"""Signs that tasks may draw, by name."""


def legend(
    options: Sequence[str],
    signs: Sequence[str] = (),
    models: Sequence[str] = (),
    walled: bool = False,
    zoned: bool = False,
) -> list[Sign]:
    """Return the entries of a legend: options, models of robots, and what else there is to see."""
    held = [Sign(name, OPTION_COLOURS[k % len(OPTION_COLOURS)]) for k, name in enumerate(options)]
    marks = [LOOK.marks[k % len(LOOK.marks)] for k in range(len(models))]
    marked = [Sign(name, LOOK.ink, mark or "disc", 0.2) for name, mark in zip(models, marks, strict=True) if mark]
    return [
        *held,
        *marked,
        LOOK.failed,
        *([sign for name, sign in SIGN_OF.items() if name in signs] or LOOK.areas),
        LOOK.pheromones,
        *((LOOK.zone,) if zoned else ()),
        *((LOOK.wall,) if walled else ()),
    ]
