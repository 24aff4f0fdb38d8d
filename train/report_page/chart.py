"""Charts as SVG inside a page: a frame with scales, and marks in the colours of the page.

Colours are classes of the page's style, so that a chart is dark where the page is dark.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

ROW = 26
"""Height of a row of a chart of rows [pixels]."""
UNDER = 34
"""Height of the scale below a chart [pixels]."""
LOG_FROM = 20.0
"""Ratio of the largest to the least value from which a scale is logarithmic."""
COLOURS = 9


@dataclass(frozen=True)
class Axis:
    """A scale from `low` to `high`, both positive if it is logarithmic."""

    low: float
    high: float
    log: bool = False

    @classmethod
    def over(cls, values: Sequence[float], *, zero: bool = False) -> Axis:
        """Return the scale of values, from 0 if `zero`; logarithmic if they are positive and far apart."""
        finite = [value for value in values if math.isfinite(value)] or [0.0]
        low, high = min(finite), max(finite)
        if not zero and low > 0.0 and high > LOG_FROM * low:
            return cls(low / 1.1, high * 1.1, log=True)
        low = min(low, 0.0) if zero else low
        room = 0.05 * (high - low) or 0.5 * abs(high) or 1.0
        return cls(low if zero and low == 0.0 else low - room, high + room)

    def share(self, value: float) -> float:
        """Return where a value is, from 0 at the lower to 1 at the upper end; values beyond are at the ends."""
        if self.log:
            value = max(value, self.low)
            where = math.log(value / self.low) / math.log(self.high / self.low)
        else:
            where = (value - self.low) / (self.high - self.low)
        return min(max(where, 0.0), 1.0)

    def ticks(self) -> list[float]:
        """Return round values on the scale."""
        if self.log:
            powers = range(math.floor(math.log10(self.low)), math.ceil(math.log10(self.high)) + 1)
            return [f * 10.0**p for p in powers for f in (1.0, 2.0, 5.0) if self.low <= f * 10.0**p <= self.high]
        rough = (self.high - self.low) / 5.0
        power = 10.0 ** math.floor(math.log10(rough))
        step = next(f * power for f in (1.0, 2.0, 5.0, 10.0) if f * power >= rough)
        first = math.ceil(self.low / step)
        return [k * step for k in range(first, math.floor(self.high / step) + 1)]


class Chart:
    """A chart of `width` and `height` [pixels] without its margins; marks are given by values of its scales."""

    def __init__(self, x: Axis, y: Axis, size: tuple[int, int], left: int = 60) -> None:
        self.x, self.y, (self.width, self.height), self.left = x, y, size, left
        self._parts: list[str] = []

    def place(self, x: float, y: float) -> tuple[float, float]:
        """Return the place of values [pixels]."""
        return self.left + self.x.share(x) * self.width, 6 + (1.0 - self.y.share(y)) * self.height

    def line(self, points: Sequence[tuple[float, float]], look: str, told: str = "") -> None:
        """Draw a line through points."""
        places = " ".join(f"{x:.1f},{y:.1f}" for x, y in (self.place(*point) for point in points))
        self._parts.append(f'<polyline points="{places}" class="line {look}">{_title(told)}</polyline>')

    def area(self, points: Sequence[tuple[float, float]], look: str, told: str = "") -> None:
        """Fill the area within points."""
        places = " ".join(f"{x:.1f},{y:.1f}" for x, y in (self.place(*point) for point in points))
        self._parts.append(f'<polygon points="{places}" class="{look}">{_title(told)}</polygon>')

    def dot(self, x: float, y: float, look: str, told: str = "", radius: float = 3.0) -> None:
        """Draw a dot."""
        px, py = self.place(x, y)
        self._parts.append(f'<circle cx="{px:.1f}" cy="{py:.1f}" r="{radius:g}" class="{look}">{_title(told)}</circle>')

    def words(self, x: float, y: float, text: str, look: str = "", shift: tuple[float, float] = (0.0, 0.0)) -> None:
        """Write text that begins at values, shifted by pixels."""
        px, py = self.place(x, y)
        place = f'x="{px + shift[0]:.1f}" y="{py + shift[1] + 4:.1f}"'
        self._parts.append(f'<text {place} class="{look}">{escape(text)}</text>')

    def svg(self, x_title: str, *, rows: bool = False) -> str:
        """Return the chart with its scales; a chart of rows has no scale of y."""
        frame = []
        for tick in self.x.ticks():
            px, _ = self.place(tick, self.y.low)
            frame.append(f'<line x1="{px:.1f}" x2="{px:.1f}" y1="6" y2="{6 + self.height}" class="grid"/>')
            frame.append(f'<text x="{px:.1f}" y="{20 + self.height}" class="tick middle">{_number(tick)}</text>')
        for tick in [] if rows else self.y.ticks():
            _, py = self.place(self.x.low, tick)
            frame.append(
                f'<line x1="{self.left}" x2="{self.left + self.width}" y1="{py:.1f}" y2="{py:.1f}" class="grid"/>'
            )
            frame.append(f'<text x="{self.left - 6}" y="{py + 4:.1f}" class="tick end">{_number(tick)}</text>')
        title = (
            f'<text x="{self.left + self.width}" y="{self.height + UNDER}" class="tick end">{escape(x_title)}</text>'
        )
        wide, high = self.left + self.width + 20, self.height + UNDER + 6
        head = f'<svg viewBox="0 0 {wide} {high}" width="{wide}" height="{high}" role="img">'
        return "".join([head, *frame, *self._parts, title, "</svg>"])


def _title(told: str) -> str:
    return f"<title>{escape(told)}</title>" if told else ""


def _number(value: float) -> str:
    return f"{value:.4g}" if abs(value) < 1e5 else f"{value:.2g}"
