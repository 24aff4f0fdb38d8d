"""The tables of a comparison as Markdown, its learning curves, and what has to hold."""

import json
from collections import Counter
from functools import cached_property
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from scipy.stats import trim_mean

from docs.comparison.manifest import Ablations, Manifest
from docs.comparison.pairs import pairs_table
from docs.comparison.runs import CONFIGURED, CPU_TIMES, looked_ahead_file
from train.analysis.family_report import excesses_of, limit_ratios, unfinished_of
from train.analysis.statistics import share_cell
from train.analysis.strategy_comparison import BestFixed
from train.deciders.named import FIXED
from train.evaluation.claims import Claim, claims_of, family_runs
from train.evaluation.entrants import RANDOM
from train.evaluation.look_ahead import LOOKING, shares_of
from train.reports.text_table import interval_cell, markdown_table

TOLERANCE = 1.02
"""Largest ratio on a control."""


class Results:
    """The results of all families.

    Args:
        manifest: the comparison.
        folder: directory of its results.

    Attributes:
        best: family -> the best fixed option of the library.

    """

    def __init__(self, manifest: Manifest, folder: Path) -> None:
        self._manifest, self._folder = manifest, folder
        self._runs = {name: family_runs(folder / name) for name in manifest.families}
        self._excesses = {name: excesses_of(own) for name, own in self._runs.items()}
        self.best = {
            name: BestFixed.of(own, [label for label in self._runs[name].fixed if label != CONFIGURED])
            for name, own in self._excesses.items()
        }
        for name, best in self.best.items():
            self._excesses[name][best.label] = best.judged(self._excesses[name])

    def claims(self, label: str, against: str = "") -> dict[str, Claim]:
        """Return family -> claim about a strategy beside another one, or beside the best fixed option of each."""
        others = {name: against or best.label for name, best in self.best.items()}
        return {claim.family: claim for claim in claims_of(self._excesses, [label], others)}

    def tables(self) -> dict[str, str]:
        """Return name -> table."""
        tables = {"main": self._main(), "limits": self._limits(), "statistics": self._statistics()}
        tables["learners"] = self._learners()
        if any(compared.looked_ahead for compared in self._manifest.families.values()):
            tables["looking"] = self._looking()
        if self._manifest.ablations is not None:
            tables["ablations"] = self._ablated(self._manifest.ablations)
        if self._manifest.pairs is not None:
            tables["pairs"] = pairs_table(self._manifest.pairs, self._folder, _ratio)
        return tables

    def broken(self) -> list[str]:
        """Return what does not hold of the main claims: the selector costs less than each baseline."""
        claimed = self._manifest.claimed
        bounds = {name: TOLERANCE if one.control else 1.0 for name, one in self._manifest.families.items()}
        return [
            f"{name}: expected {claimed} below {bounds[name]:g} of {claim.against}, got {claim.ratio:.3f}"
            for by_family in self._main_claims.values()
            for name, claim in by_family.items()
            if claim.ratio >= bounds[name]
        ]

    def draw_curves(self, file: Path) -> None:
        """Draw what validation missions of the first family cost after so much CPU time, up to twice the lowest."""
        figure = Figure(figsize=(7.5, 4.2), layout="constrained")
        axes, family, lowest = figure.add_subplot(), next(iter(self._manifest.families)), np.inf
        for number, (label, learner) in enumerate(self._manifest.learners.items()):
            files = [self._folder / f"{label}-{seed}" / "history.jsonl" for seed in learner.seeds]
            curves = np.array([_curve(file, family) for file in files])
            took = self._cpu_minutes(label) / curves.shape[1] * np.arange(1, curves.shape[1] + 1)
            axes.plot(took, curves.T, color=f"C{number}", alpha=0.3, lw=0.9)
            axes.plot(took, curves.mean(axis=0), color=f"C{number}", marker="o", lw=2.0, label=f"{label}, mean")
            lowest = min(lowest, curves.min())
        axes.set(
            xlabel="CPU minutes of training", ylabel=f"cost of validation on {family} [s]", ylim=(0.0, 2.0 * lowest)
        )
        axes.legend(frameon=False)
        figure.savefig(file, dpi=110)

    @property
    def _by_hand(self) -> tuple[str, ...]:
        """Labels of the strategies that learn nothing, but for fixed options."""
        return *self._manifest.unlearned, RANDOM

    @cached_property
    def _main_claims(self) -> dict[str, dict[str, Claim]]:
        """Head of a column, what the claimed learner has to be better than -> family -> claim."""
        configured = {"configured": CONFIGURED} if self._manifest.configured is not None else {}
        learned = (label for label, learner in self._manifest.learners.items() if learner.baseline)
        labels = (*learned, *self._by_hand)
        others = {"best fixed": "", **configured, **{f"`{label}`": label for label in labels}}
        return {head: self.claims(self._manifest.claimed, other) for head, other in others.items()}

    def _cpu_minutes(self, label: str) -> float:
        """Return the mean CPU time of the trainings of a learner [min]; not a number if none was measured."""
        times = json.loads((self._folder / CPU_TIMES).read_text(encoding="utf-8"))
        names = [f"{label}-{seed}" for seed in self._manifest.learners[label].seeds]
        return float(np.mean([times[name] for name in names if name in times])) / 60.0

    def _main(self) -> str:
        """Return the claimed learner beside each baseline: a row for each family."""
        claimed, claims = self._manifest.claimed, self._main_claims
        heads = ["family", "scenarios", "best fixed", "its excess s", *(f"{claimed} / {head}" for head in claims)]
        rows = []
        for name, compared in self._manifest.families.items():
            best = self.best[name].label
            own = [f"`{name}`" + (", a control" if compared.control else ""), str(compared.scenarios)]
            own += [best.replace(f"{FIXED}:", ""), f"{self._excesses[name][best].mean():.1f}"]
            rows.append([*own, *(_ratio(by_family[name]) for by_family in claims.values())])
        return markdown_table(heads, rows)

    def _limits(self) -> str:
        """Return shares of unfinished missions, and ratios to the best fixed option by other prices of items left."""
        labels = [*self._manifest.learners, *self._by_hand]
        cells: dict[str, list[str]] = {label: [] for label in [*labels, "best fixed"]}
        for name, runs in self._runs.items():
            best, left = self.best[name], unfinished_of(runs)
            ratios = limit_ratios(runs, best)
            shares = {label: share_cell(float(left[label].mean())) for label in labels} if left else {}
            for label in labels:
                others = ", ".join(f"{one.ratio:.3f}" for one in ratios.get(label, ()))
                cells[label].append("; ".join(filter(None, [shares.get(label), others])))
            cells["best fixed"].append(share_cell(float(best.judged(left).mean())) if left else "")
        return markdown_table(["", *(f"`{name}`" for name in self._runs)], [[k, *own] for k, own in cells.items()])

    def _learners(self) -> str:
        """Return all learners beside the best fixed option of each family."""
        labels = [*self._manifest.learners, *self._by_hand]
        claims = {label: self.claims(label) for label in labels}
        rows = []
        for label in labels:
            learner = self._manifest.learners.get(label)
            row = [
                f"`{label}`",
                *((str(len(learner.seeds)), f"{self._cpu_minutes(label):.1f}") if learner else ("", "")),
            ]
            for name in self._manifest.families:
                each = (
                    self._excesses[name][label].mean(axis=(1, 2)) / self._excesses[name][self.best[name].label].mean()
                )
                spread = f"; {each.min():.2f} to {each.max():.2f}" if len(each) > 1 else ""
                row.append(_ratio(claims[label][name]) + spread)
            rows.append(row)
        return markdown_table(
            ["", "trainings", "CPU min each", *(f"`{name}`" for name in self._manifest.families)], rows
        )

    def _ablated(self, ablations: Ablations) -> str:
        """Return each ablation beside the learner whose training it is."""
        rows = []
        for label, ablation in ablations.of.items():
            whole = ablation.learner or self._manifest.claimed
            claims = self.claims(label, whole)
            rows.append([label, whole, *(_ratio(claims[name]) for name in self._manifest.families)])
        return markdown_table(["", "beside", *(f"`{name}`" for name in self._manifest.families)], rows)

    def _statistics(self) -> str:
        """Return interquartile means of the excess, and how often the claimed learner is better."""
        labels = [self._manifest.claimed, *self._by_hand]
        rows = []
        for name, own in self._excesses.items():
            best = own[self.best[name].label].ravel()
            middles = [f"{trim_mean(own[label].ravel(), 0.25):.1f}" for label in labels]
            claimed = own[self._manifest.claimed].reshape(-1, len(best))
            better = np.mean((claimed < best) + 0.5 * (claimed == best))
            rows.append([f"`{name}`", f"{trim_mean(best, 0.25):.1f}", *middles, f"{better:.0%}"])
        heads = ["family", "best fixed", *(f"`{label}`" for label in labels), f"{self._manifest.claimed} is better"]
        return markdown_table(heads, rows)

    def _looking(self) -> str:
        """Return how far the claimed learner comes on the way from the best fixed option to looking ahead."""
        rows = []
        for name, compared in self._manifest.families.items():
            if not compared.looked_ahead:
                continue
            content = json.loads(looked_ahead_file(self._folder, name).read_text(encoding="utf-8"))
            own = {label: values[:, : compared.looked_ahead] for label, values in self._excesses[name].items()}
            own[LOOKING] = np.array(content["excess_s"])[None, :, None]
            claim, *_ = claims_of({name: own}, [LOOKING], {name: self.best[name].label})
            best, claimed, looked = (
                own[label].mean() for label in (self.best[name].label, self._manifest.claimed, LOOKING)
            )
            share = f"{(best - claimed) / (best - looked):.0%}" if claim.ci95[1] < 1.0 else "no gap is shown"
            taken = shares_of(Counter(content["taken"]), 3)
            rows.append([f"`{name}`", f"{best:.1f}", f"{claimed:.1f}", f"{looked:.1f}", _ratio(claim), share, taken])
        heads = ["family", "best fixed, excess s", self._manifest.claimed, LOOKING, "to best fixed", "share of the way"]
        return markdown_table([*heads, "it takes"], rows)


def _curve(history: Path, family: str) -> list[float]:
    """Return the costs of validation at the checkpoints that have them."""
    lines = [json.loads(line) for line in history.read_text(encoding="utf-8").splitlines()]
    return [line[key] for line in lines if (key := f"{family}/cost_s") in line]


def _ratio(claim: Claim) -> str:
    """Return a ratio with its interval, bold where that excludes 1 for the better."""
    bold = "**" if claim.p is not None and claim.corrected[1] < 1.0 else ""
    return f"{bold}{claim.ratio:.3f}{bold} {interval_cell(claim.corrected)}"
