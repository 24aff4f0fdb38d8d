"""Charts by Matplotlib: one style and one set of colours for the pictures of evaluations and for pages of reports.

Shapes: C conditions, K scenarios.
"""

import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from io import BytesIO, StringIO
from typing import Any, Final

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import LogFormatter

from clean_swarm_env.drawing.look import OPTION_COLOURS
from selforg.arrays import Flags, Floats
from train.analysis.intervals import Estimate, Interval
from train.analysis.statistics import by_scenario
from train.analysis.verdict import LOG_FROM, amount, interval_words

TEXT_COLOUR: Final = "#1b1b1b"
"""Colour of text and axes; on a page it becomes the colour of the page's text."""
STYLE: Final[dict[Any, Any]] = {
    "font.size": 9,
    "font.sans-serif": ["DejaVu Sans"],
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.color": "#88888844",
    **dict.fromkeys(("text.color", "axes.edgecolor", "axes.labelcolor", "xtick.color", "ytick.color"), TEXT_COLOUR),
    "text.parse_math": False,
    "svg.fonttype": "none",
    "svg.hashsalt": "clean-swarm",
}
BEYOND: Final = 1.15
"""Factor by which axes reach beyond the farthest point."""
LONGEST_LABEL: Final = 44
"""Letters of a label; longer ones are cut."""
SPREAD: Final = 0.25
"""Half the height of the points of a row, in rows."""


@contextmanager
def panels(rows: int, columns: int, size: tuple[float, float], *, shared: bool = False) -> Iterator[tuple[Figure, Any]]:
    """Yield a figure of `size` [inch] in our style, and its axes (rows, columns).

    `shared`: those of a row share y, those of a column x.
    """
    with mpl.rc_context(STYLE), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph")  # letters that the font does not have are boxes
        figure = Figure(figsize=size, layout="constrained")
        how: dict[str, Any] = {"sharex": "col", "sharey": "row"} if shared else {}
        yield figure, figure.subplots(rows, columns, squeeze=False, **how)


def picture_of(figure: Figure, suffix: str) -> bytes:
    """Return a figure as a file that ends in `.svg`, `.png` or `.pdf`; equal figures give equal files."""
    undated = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}, ".png": {"Software": "clean-swarm"}}[suffix]
    image = BytesIO()
    with mpl.rc_context({**STYLE, "pdf.fonttype": 42}):
        figure.savefig(image, format=suffix[1:], dpi=150, metadata=undated)
    return image.getvalue()


def svg(figure: Figure) -> str:
    """Return a figure as an element of a page, in the colours of its text and background; equal for equal figures."""
    image = StringIO()
    unsaid = dict.fromkeys(("Date", "Creator", "Format", "Type"))
    with mpl.rc_context(STYLE):
        figure.savefig(image, format="svg", transparent=True, metadata=unsaid)
    text = image.getvalue()
    return f'<div class="wide">{text[text.index("<svg") :].replace(TEXT_COLOUR, "currentColor")}</div>'


def colour_of(place: int) -> str:
    """Return the colour of the condition at a place, or of the option, as in pictures of robots."""
    return OPTION_COLOURS[place % len(OPTION_COLOURS)]


def label_of(name: str) -> str:
    """Return a name, each line of it cut if it is too long for a chart."""
    return "\n".join(
        line if len(line) <= LONGEST_LABEL else f"{line[: LONGEST_LABEL - 3]}..." for line in name.split("\n")
    )


class _PlainNumbers(LogFormatter):
    """Names the same ticks as its base class, in numbers without an exponent."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        return f"{x:g}" if super().__call__(x, pos) else ""


def log_scale(axes: Axes, name: str) -> None:
    """Make the axis x or y logarithmic, with plain numbers."""
    axes.set(**{f"{name}scale": "log"})
    axis: Axis = {"x": axes.xaxis, "y": axes.yaxis}[name]
    for choose in (axis.set_major_formatter, axis.set_minor_formatter):
        choose(_PlainNumbers(minor_thresholds=(2.0, 0.8), labelOnlyBase=False))


def fit_axis(axes: Axes, values: Floats, name: str = "x") -> None:
    """Show no more of the axis x or y than values have, logarithmic if they are far apart, and nothing below 0."""
    known = values[np.isfinite(values)]
    if known.size and known.min() > 0.0 and known.max() > LOG_FROM * known.min():
        log_scale(axes, name)
        axes.set(**{f"{name}lim": (known.min() / BEYOND, known.max() * BEYOND)})
    elif known.size and known.min() >= 0.0:
        axes.set(**{f"{name}lim": (0.0, BEYOND * known.max() or 1.0)})


def error_bar(value: float, ci95: Interval | None) -> list[list[float]]:
    """Return the lengths of an error bar below and above a value, as Matplotlib asks for them.

    >>> error_bar(0.0, (1e-18, 0.1))  # by rounding, the interval begins above the share
    [[0.0], [0.1]]

    """
    low, high = ci95 or (value, value)
    return [[max(value - low, 0.0)], [max(high - value, 0.0)]]


def draw_rows(
    axes: Axes,
    values: Floats,
    scenarios: Sequence[str],
    labels: Sequence[str],
    places: Sequence[int],
    hollow: Flags | None = None,
) -> None:
    """Draw a row for each condition: every run, the quartiles, and the mean with its 95 % interval.

    Args:
        axes: where to draw.
        values: (C, K), NaN where there is none.
        scenarios: their names; the worlds of one count once in the interval.
        labels: names of the conditions.
        places: of the conditions among all, for their colours.
        hollow: (C, K) runs whose points are hollow.

    """
    heights = np.arange(len(values))[:, None] + SPREAD * np.cos(np.arange(values.shape[1]) * np.pi * (3.0 - 5.0**0.5))
    for row, place in enumerate(places):
        colour, known = colour_of(place), np.isfinite(values[row])
        filled = known if hollow is None else known & ~hollow[row]
        axes.scatter(values[row, filled], heights[row, filled], s=12, color=colour, alpha=0.6, linewidths=0)
        axes.scatter(
            values[row, known & ~filled], heights[row, known & ~filled], s=14, facecolors="none", edgecolors=colour
        )
        if not known.any():
            continue
        first, third = np.quantile(values[row, known], [0.25, 0.75])
        axes.barh(row, third - first, 0.5, first, color=colour, alpha=0.2)
        mean = Estimate.of_amounts(by_scenario(values[row], scenarios)[None])
        spread = error_bar(mean.value, mean.ci95)
        axes.errorbar(mean.value, row, xerr=spread, fmt="D", color=colour, mec="white", ms=7, lw=2, zorder=4)
        said = f"{amount(mean.value)}{interval_words(mean.ci95, amount)}".replace(" ", "\n", 1)
        axes.text(1.02, row, said, transform=axes.get_yaxis_transform(), va="center")
    axes.set_yticks(range(len(values)), [label_of(label) for label in labels])
    axes.set_ylim(len(values) - 0.5, -0.5)
    axes.grid(axis="x")
