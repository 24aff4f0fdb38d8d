"""Block diagrams: boxes with a title and lines, frames around them, labelled arrows between their sides."""

from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch

INK, PALE = "#1b2a41", "#5f6b7a"
BLUE, ORANGE, GREEN, GREY, YELLOW, PINK = "#d4e9f7", "#fbe3bd", "#d2efe4", "#eceff1", "#fbf6d0", "#f3e6ee"
SIDES = {"left": (0.0, 0.5), "right": (1.0, 0.5), "top": (0.5, 1.0), "bottom": (0.5, 0.0)}


@dataclass(frozen=True)
class Block:
    """A box: lower left corner, width and height [inch], title, what stands below it, and its colour."""

    x: float
    y: float
    width: float
    height: float
    title: str
    lines: Sequence[str] = ()
    colour: str = "white"

    def at(self, side: str, along: float | None = None) -> tuple[float, float]:
        """Return a point on a side: its middle, or `along` of it, 0 left or bottom to 1."""
        x, y = SIDES[side]
        if along is not None:
            x, y = (along, y) if side in ("top", "bottom") else (x, along)
        return self.x + x * self.width, self.y + y * self.height


def canvas(width: float, height: float, title: str) -> tuple[Figure, Axes]:
    """Return a figure of this size [inch] whose axes count inches, with a title at the top."""
    figure = Figure(figsize=(width, height), facecolor="white")
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(0.0, width), ylim=(0.0, height))
    axes.axis("off")
    axes.text(0.2, height - 0.28, title, fontsize=12, weight="bold", color=INK, va="center")
    return figure, axes


def draw_block(axes: Axes, block: Block, size: float = 8.5) -> Block:
    """Draw a box, its text centred, and return it."""
    _draw_outline(axes, block, "solid", 1.0, 3.0)
    step = size / 72.0 * 1.45
    middle = block.y + 0.5 * block.height + 0.5 * step * len(block.lines)
    centre = block.x + 0.5 * block.width
    axes.text(
        centre, middle, block.title, fontsize=size + 0.5, weight="bold", color=INK, ha="center", va="center", zorder=4
    )
    for index, line in enumerate(block.lines, 1):
        axes.text(centre, middle - index * step, line, fontsize=size, color=INK, ha="center", va="center", zorder=4)
    return block


def draw_frame(axes: Axes, block: Block, size: float = 9.0) -> Block:
    """Draw a frame for other boxes, its title in the upper left corner, and return it."""
    _draw_outline(axes, block, (0, (5, 3)), 1.1, 1.0)
    text = "\n".join((block.title, *block.lines))
    axes.text(
        block.x + 0.1, block.y + block.height - 0.09, text, fontsize=size, weight="bold", color=PALE, va="top", zorder=2
    )
    return block


def _draw_outline(axes: Axes, block: Block, style: object, width: float, zorder: float) -> None:
    outline = FancyBboxPatch(
        (block.x, block.y), block.width, block.height, boxstyle="round,pad=0,rounding_size=0.07",
        facecolor=block.colour, edgecolor=PALE if zorder < 2 else INK, linestyle=style, linewidth=width, zorder=zorder,
    )  # fmt: skip
    axes.add_patch(outline)


def draw_arrow(
    axes: Axes, start: tuple[float, float], end: tuple[float, float], label: str = "", bend: float = 0.0,
    shift: tuple[float, float] = (0.0, 0.0),
) -> None:  # fmt: skip
    """Draw an arrow with a label near its middle, moved by `shift` [inch]; `bend` curves the arrow."""
    arrow = FancyArrowPatch(
        start, end, arrowstyle="-|>", mutation_scale=11, color=INK, linewidth=1.2, shrinkA=0, shrinkB=1,
        connectionstyle=f"arc3,rad={bend}", zorder=5,
    )  # fmt: skip
    axes.add_patch(arrow)
    if label:
        x, y = 0.5 * (start[0] + end[0]) + shift[0], 0.5 * (start[1] + end[1]) + shift[1]
        box = {"facecolor": "white", "edgecolor": "none", "pad": 1.0, "alpha": 0.9}
        axes.text(x, y, label, fontsize=7.5, color=INK, ha="center", va="center", bbox=box, zorder=6)
