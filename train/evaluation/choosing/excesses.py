"""Excess costs of strategies on the same scenarios, each beside those of another one.

Shapes: S members of a strategy, K scenarios.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from clean_swarm_env.config.families import FamilyConfig
from clean_swarm_env.world.mission import MissionResult
from selforg.arrays import Floats
from train.analysis.family_report import unfinished
from train.analysis.intervals import Ratio, too_few
from train.analysis.statistics import share_cell
from train.reports.text_table import EMPTY_CELL, Grid, interval_cell
from train.reports.write_report import Publication


@dataclass(frozen=True)
class ExcessComparison:
    """Results of strategies on a family, and what each is compared with."""

    family: FamilyConfig
    results: Mapping[str, Sequence[Sequence[MissionResult]]]
    """Label -> (S, K)."""
    against: Mapping[str, str]
    """Label -> label of what it is compared with; itself for what others are compared with."""

    def excesses(self, label: str) -> Floats:
        """Return the excess costs (S, K) of a strategy [s]."""
        return np.array([[result.excess_s for result in row] for row in self.results[label]])

    def ratio(self, label: str) -> Ratio:
        """Return the ratio of the mean excess to that of the strategy's yardstick."""
        return Ratio.of(self.excesses(label), self.excesses(self.against[label]).mean(axis=0))

    def publication(self, title: str, head: str, notes: Sequence[str] = ()) -> Publication:
        """Return the table, whose column of ratios has the title `head`, and the figures."""
        rows, summary, told = [], dict[str, dict[str, object]](), []
        for label, results in self.results.items():
            excess = float(self.excesses(label).mean())
            left = unfinished(self.family.mission, [result for row in results for result in row])
            summary[label] = {"excess_s": excess, "unfinished": left}
            cells = ("1", "")
            if self.against[label] != label:
                ratio = self.ratio(label)
                told.append(ratio)
                summary[label] |= {"against": self.against[label], **ratio.content}
                cells = (EMPTY_CELL if ratio.ratio is None else f"{ratio.ratio:.3f}", interval_cell(ratio.ci95))
            rows.append((label, share_cell(left), f"{excess:.1f}", *cells))
        heads = ("strategy", "unfinished", "excess s", head, "95 %")
        grid = Grid(f"{self.family.name}: {title}", heads, rows, notes=(*notes, *too_few(told)))
        heading = f"# {self.family.name}\n\n{self.family.description}\n\n"
        content = {"family": self.family.name, "strategies": summary, "notes": list(notes)}
        return Publication(heading, [grid], json.dumps(content, indent=2) + "\n")
