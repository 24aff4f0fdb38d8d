"""What scores in the loop cost: tables as Markdown, and the picture."""

from collections.abc import Mapping
from functools import cached_property
from itertools import product
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from docs.comparison.loop import (
    EXPERTS,
    LEARNERS,
    RIGHT,
    STARTS,
    WRONG,
    LoopManifest,
    chosen_numbers,
    learned_choices,
    spec_with,
    stored_choices,
)
from docs.comparison.loop_runs import LoopedRuns
from selector.strategies.registry import StrategySpec
from selforg.arrays import Floats, Ints
from train.analysis.intervals import Ratio
from train.reports.text_table import interval_cell, markdown_table

BY_SCORE = "MaxScore"
"""The strategy that does not learn."""
END, NEVER = 1.02, 1.05
"""Largest ratio to the best option at the end; and at any time to the experts' option, if its score was right."""
RATIOS = (1.0, 1.2, 1.5, 2.0, 3.0, 5.0, 8.0)
"""Marks of the picture's axis, in each power of ten."""
SMOOTHED = 10
"""Missions over which the picture takes means."""
DEFAULTS = "defaults"
"""Key of a strategy with its default numbers, in place of a start."""


class LoopResults:
    """The results on all families.

    Args:
        manifest: what is learned where.
        runs: family -> its runs.

    Attributes:
        numbers: strategy -> the numbers that were best on training missions.

    """

    def __init__(self, manifest: LoopManifest, runs: Mapping[str, LoopedRuns]) -> None:
        self._manifest, self._runs = manifest, runs
        self.numbers = chosen_numbers(manifest, {label: own.training for label, own in runs.items()})

    @cached_property
    def taken(self) -> dict[tuple[str, str, str], Ints]:
        """Family, start and strategy -> the options that it took (S, K)."""
        found, seeds = {}, self._manifest.seeds
        for (label, own), start in product(self._runs.items(), STARTS):
            known = own.training.starting(start)
            found[label, start, BY_SCORE] = stored_choices(known, own.missions)[0]
            for name in LEARNERS:
                spec = spec_with(self._manifest, name, self.numbers[name], own.training)
                found[label, start, name] = learned_choices(spec, known, own.missions, seeds)
        for (label, own), name in product(self._runs.items(), LEARNERS):
            spec = StrategySpec(name=name, sharing="robot")
            found[label, DEFAULTS, name] = learned_choices(spec, own.missions.knowledge, own.missions, seeds)
        return found

    def tables(self) -> dict[str, str]:
        """Return name -> table."""
        families = {f"scores of {label}": self._family(label) for label in self._runs}
        return {"held": self._held(), **families, "numbers": self._numbers(), "families": self._families()}

    def end(self, label: str, start: str, name: str) -> Ratio:
        """Return the cost of the last missions beside the option that was best on all missions before them."""
        missions, last = self._runs[label].missions, self._manifest.last
        best = int(missions.excess[:, :, :-last].mean(axis=(0, 2)).argmin())
        paid = missions.paid(self.taken[label, start, name])
        return Ratio.of(paid[:, -last:].mean(axis=1), missions.excess[:, best, -last:].mean(axis=1))

    def from_right(self, label: str, name: str) -> tuple[Ratio, float]:
        """Return the cost of a strategy whose scores were right, beside the option of the highest: in all, at worst.

        The worst part is as many missions in a row, of all seeds, as judge the end.
        """
        own, count = self._runs[label], self._manifest.last
        scores = own.training.starting(RIGHT).scores(own.missions.goal)
        paid, expert = own.missions.paid(self.taken[label, RIGHT, name]), own.missions.excess[:, int(scores.argmax())]
        windows = [slice(first, first + count) for first in range(paid.shape[1] - count + 1)]
        worst = max(float(paid[:, part].mean() / expert[:, part].mean()) for part in windows)
        return Ratio.of(paid.mean(axis=1), expert.mean(axis=1)), worst

    def draw(self, file: Path) -> None:
        """Draw the cost beside the best option, smoothed: means of the seeds, and bands from the least to the most."""
        starts, figure = (EXPERTS, WRONG), Figure(figsize=(11.0, 3.1 * len(self._runs)), layout="constrained")
        grid = figure.subplots(len(self._runs), len(starts), sharey="row", sharex=True, squeeze=False)
        for row, (label, own) in zip(grid, self._runs.items(), strict=True):
            best = own.missions.excess[:, int(own.missions.excess.mean(axis=(0, 2)).argmin())]
            for axes, start in zip(row, starts, strict=True):
                for number, name in enumerate(self._manifest.drawn):
                    _draw_band(axes, own.missions.paid(self.taken[label, start, name]), best, f"C{number}", name)
                for style, (name, paid) in zip((":", "--"), reversed(own.beside.items()), strict=False):
                    axes.plot(*_curve(paid.mean(axis=0), best.mean(axis=0)), "0.3", lw=1.1, ls=style, label=name)
                axes.axhline(1.0, color="0.6", lw=0.8)
                axes.set_yscale("log")
                axes.yaxis.set_major_locator(LogLocator(subs=RATIOS))
                axes.yaxis.set_major_formatter("{x:g}")
                axes.yaxis.set_minor_locator(NullLocator())
                axes.set_title(f"{label}, from {start} scores", fontsize=10)
                axes.grid(alpha=0.25)
            row[0].set_ylabel("excess / that of the best option")
        for axes in grid[-1]:
            axes.set_xlabel("mission")
        shown = {str(line.get_label()): line for axes in grid.flat for line in axes.lines[: len(axes.lines) - 1]}
        figure.legend(shown.values(), shown.keys(), loc="outside upper center", ncols=len(shown), fontsize=9)
        figure.savefig(file, dpi=110, metadata={"Software": "clean-swarm"})

    def _held(self) -> str:
        """Return in how many cases each strategy ends as it should, and is never worse than it should be."""
        rows = []
        for name in (BY_SCORE, *LEARNERS):
            ends = [[(self.end(label, start, name).ratio or np.inf) <= END for label in self._runs] for start in STARTS]
            never = sum(self.from_right(label, name)[1] <= NEVER for label in self._runs)
            rows.append([f"`{name}`", *(f"{sum(own)} of {len(own)}" for own in ends), f"{never} of {len(self._runs)}"])
        heads = (f"{100.0 * (END - 1.0):.0f} % at the end, from {start} scores" for start in STARTS)
        return markdown_table(["", *heads, f"{100.0 * (NEVER - 1.0):.0f} % at any time, from right scores"], rows)

    def _family(self, label: str) -> str:
        """Return what each strategy costs on a family."""
        rows = []
        for name in (BY_SCORE, *LEARNERS):
            ends = [_cell(self.end(label, start, name), END) for start in STARTS]
            whole, worst = self.from_right(label, name)
            default = f"{self.end(label, DEFAULTS, name).ratio:.2f}" if name in LEARNERS else ""
            rows.append([f"`{name}`", *ends, _cell(whole, NEVER), _bold(f"{worst:.2f}", worst <= NEVER), default])
        own, last = self._runs[label], self._manifest.last
        best = int(own.missions.excess[:, :, :-last].mean(axis=(0, 2)).argmin())
        yardstick = own.missions.excess[:, best, -last:].mean(axis=1)
        for name, paid in reversed(own.beside.items()):
            rows.append([f"`{name}`", _cell(Ratio.of(paid[:, -last:].mean(axis=1), yardstick), END), *[""] * 5])
        heads = [f"end, from {start}" for start in STARTS]
        return markdown_table(["", *heads, "all, from right", "worst, from right", "end, default numbers"], rows)

    def _numbers(self) -> str:
        """Return the numbers of strategies that were best on training missions."""
        rows = [
            [f"`{name}`", ", ".join(f"{key} {value:g}" for key, value in own.items())]
            for name, own in self.numbers.items()
        ]
        return markdown_table(["", f"{', '.join(self._manifest.scaled)} in units of the spread"], rows)

    def _families(self) -> str:
        """Return the options and scores of each family, and what it costs to try each option once."""
        rows = []
        for label, own in self._runs.items():
            means, options = own.missions.excess.mean(axis=(0, 2)), own.missions.options
            best, scores = int(means.argmin()), own.missions.knowledge.scores(own.missions.goal)
            expert, count = int(scores.argmax()), own.missions.excess.shape[2]
            trials = (means - means[best]).sum() / (count * means[best])
            right = own.training.starting(RIGHT).scores(own.missions.goal)
            row = [f"`{label}`", own.missions.goal, str(len(options)), f"{options[best]}, {means[best]:.1f} s"]
            row += [f"{options[expert]}, {means[expert] / means[best]:.2f}", options[int(right.argmax())]]
            rows.append([*row, f"{means.max() / means[best]:.1f}", f"{own.training.spread:.3g}", f"{trials:.0%}"])
        heads = ["family", "goal", "options", "best option, its excess", "experts', excess / best's"]
        heads += ["best of training", "worst / best", "spread of scores", "each option tried once"]
        return markdown_table(heads, rows)


def _cell(ratio: Ratio, largest: float) -> str:
    """Return a ratio with its interval, bold if it is not too large."""
    value = np.inf if ratio.ratio is None else ratio.ratio
    return f"{_bold(f'{value:.2f}', value <= largest)} {interval_cell(ratio.ci95, 2)}"


def _bold(text: str, holds: bool) -> str:
    return f"**{text}**" if holds else text


def _curve(paid: Floats, best: Floats) -> tuple[Floats, Floats]:
    """Return the middle missions of as many as are smoothed, and their cost (K,) beside that of the best option."""
    window = np.ones(SMOOTHED)
    shown = np.convolve(paid, window, "valid") / np.convolve(best, window, "valid")
    return np.arange(len(shown)) + 0.5 * (SMOOTHED + 1), shown


def _draw_band(axes: Axes, paid: Floats, best: Floats, colour: str, name: str) -> None:
    """Draw the cost (S, K) of a strategy beside that of the best option."""
    each = np.array([_curve(own, other)[1] for own, other in zip(paid, best, strict=True)])
    places, mean = _curve(paid.mean(axis=0), best.mean(axis=0))
    axes.fill_between(places, each.min(axis=0), each.max(axis=0), color=colour, alpha=0.15, lw=0.0)
    axes.plot(places, mean, color=colour, lw=1.6, label=name)
