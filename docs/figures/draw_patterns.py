"""Fig. 1 of the paper: the patterns of self-organisation by purpose, from the table `PATTERNS`."""

from itertools import groupby

from matplotlib.figure import Figure

from docs.figures.blocks import BLUE, GREY, ORANGE, Block, canvas, draw_arrow, draw_block, draw_frame
from docs.figures.purposes import PATTERNS, Pattern, Purpose

LEFTS, WIDTHS = (0.4, 2.35, 4.75, 7.55, 10.25), (1.35, 1.3, 1.75, 2.0, 1.35)
"""Columns of the patterns by how many others they build on in a row [inch]."""
FRAMES = {
    Purpose.BASIC: Block(0.2, 0.3, 3.65, 5.5, Purpose.BASIC.value, ("in the buffer of gradients",), GREY),
    Purpose.MOVEMENT: Block(4.5, 2.2, 7.3, 3.6, Purpose.MOVEMENT.value, (), BLUE),
    Purpose.DECISION: Block(4.5, 0.3, 7.3, 1.7, Purpose.DECISION.value, (), ORANGE),
}
LINE, TITLE, HEADING = 0.152, 0.3, 0.3
"""Heights of a line, of a title and of a frame's heading [inch]."""


def draw_patterns() -> Figure:
    """Return the patterns by purpose, each with its mechanisms; an arrow leads to what builds on a pattern."""
    figure, axes = canvas(12.0, 6.3, "Patterns of self-organisation by purpose")
    for frame in FRAMES.values():
        draw_frame(axes, frame)
    blocks = placed_blocks()
    for block in blocks.values():
        draw_block(axes, block, 7.5)
    for pattern in PATTERNS:
        for below in direct(pattern):
            draw_arrow(axes, blocks[below].at("right"), blocks[pattern.name].at("left"))
    return figure


def placed_blocks() -> dict[str, Block]:
    """Return the box of each pattern: in the column of its depth, spread evenly over its frame."""
    blocks = {}
    ordered = sorted(PATTERNS, key=lambda p: (p.purpose.value, depth(p)))
    for (purpose, column), group in groupby(ordered, key=lambda p: (p.purpose, depth(p))):
        patterns, frame = list(group), FRAMES[purpose]
        heights = [TITLE + LINE * max(len(p.mechanisms), 0) for p in patterns]
        gap = (frame.height - HEADING - sum(heights)) / (len(patterns) + 1)
        top = frame.y + frame.height - HEADING
        for pattern, height in zip(patterns, heights, strict=True):
            top -= gap + height
            blocks[pattern.name] = Block(
                LEFTS[column], top, WIDTHS[column], height, pattern.name, pattern.mechanisms, "white"
            )
    return blocks


def depth(pattern: Pattern) -> int:
    """Return how many patterns it builds on, one upon the other."""
    return max((1 + depth(_named(name)) for name in pattern.builds_on), default=0)


def direct(pattern: Pattern) -> list[str]:
    """Return what a pattern builds on but for what these build on themselves."""
    indirect = {below for name in pattern.builds_on for below in _all_below(_named(name))}
    return [name for name in pattern.builds_on if name not in indirect]


def _all_below(pattern: Pattern) -> set[str]:
    return set(pattern.builds_on).union(*(_all_below(_named(name)) for name in pattern.builds_on))


def _named(name: str) -> Pattern:
    return next(pattern for pattern in PATTERNS if pattern.name == name)
