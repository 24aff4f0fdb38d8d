"""Races the numbers of options on training scenarios of each family, one goal after the other.

A variant is an option of the library with another value of one parameter. All variants of a goal race beside all
options of the library, while the other goal holds what won before it, or what the manifest says. What wins meets the
best option of the library again on fresh training scenarios, and counts only if sign flips tell that it is cheaper.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from clean_swarm_env.config.families import scenario_name
from clean_swarm_env.config.load import load_family
from docs.comparison.headroom import race
from docs.comparison.manifest import Numbers
from docs.comparison.running import written
from selector.documents.fields import JOINT
from selector.knowledge import Option, load_knowledge
from train.analysis.flips import ALPHA
from train.analysis.intervals import Ratio
from train.reports.text_table import interval_cell, markdown_table
from train.running.finished_runs import JOURNAL, runs_of


@dataclass(frozen=True)
class Won:
    """What a race found for a goal.

    Attributes:
        known: the best option of the library.
        best: what won, which may be the same.
        ratio: the ratio of the excess of `best` to that of `known`, on fresh scenarios; None if they are the same.

    """

    known: str
    best: str
    ratio: Ratio | None

    @property
    def confirmed(self) -> bool:
        """Whether the variant is shown to be better than the best option of the library."""
        ratio = self.ratio
        return ratio is not None and ratio.p is not None and ratio.p < ALPHA and ratio.sign < 0.0

    @property
    def option(self) -> str:
        """The variant if it is confirmed, else the option of the library."""
        return self.best if self.confirmed else self.known


def race_numbers(numbers: Numbers, folder: Path, family: str, goals: str) -> dict[str, Won]:
    """Do the races of a family that are missing; return goal -> what was found."""
    given = load_family(family).mission.knowledge
    known = load_knowledge(given)
    held, found = {goal: numbers.held[goal] for goal in goals.split(JOINT)}, {}
    for goal in goals.split(JOINT):
        every = _every(numbers, goal, known.options(goal))
        others = {other: known.options(other) for other in known.goals if other not in held}
        fixed = {
            other: [one for one in _every(numbers, other, known.options(other)) if one.name == name]
            for other, name in held.items()
        }
        place = folder / f"numbers-of-{family}-{goal}"
        file = _knowledge(place, {**others, **fixed, goal: every})
        _race(family, goals, file, place, searched=numbers.searched, finalists=numbers.finalists, seed=numbers.seed)
        library = {one.name for one in known.options(goal)}
        best, first = _best_and_known(place, held, goal, library)
        ratio = None
        if best != first:
            place = folder / f"numbers-of-{family}-{goal}-again"
            pair = [one for one in every if one.name in (best, first)]
            file = _knowledge(place, {**others, **fixed, goal: pair})
            _race(family, goals, file, place, searched=numbers.confirmed, finalists=2, seed=numbers.fresh)
            own, other = (_excesses(place, held | {goal: name}) for name in (best, first))
            ratio = Ratio.of(own, other)
        found[goal] = Won(first, best, ratio)
        held[goal] = found[goal].option
    return found


def knowledge_with(numbers: Numbers, folder: Path, family: str, goals: str, options: str) -> Path:
    """Write knowledge of the joined options alone; return its file."""
    known = load_knowledge(load_family(family).mission.knowledge)
    held = dict(zip(goals.split(JOINT), options.split(JOINT), strict=True))
    content = {other: known.options(other) for other in known.goals if other not in held}
    for goal, name in held.items():
        content[goal] = tuple(one for one in _every(numbers, goal, known.options(goal)) if one.name == name)
    return _knowledge(folder / f"numbers-of-{family}", content)


def numbers_table(found: Mapping[str, Mapping[str, Won]]) -> str:
    """Return a row for each family and goal."""
    rows = []
    for family, each in found.items():
        for goal, won in each.items():
            ratio = won.ratio
            shown = "" if ratio is None or ratio.ratio is None else f"{ratio.ratio:.3f} {interval_cell(ratio.ci95)}"
            best = "the same" if won.best == won.known else won.best
            rows.append([f"`{family}`", goal, won.known, best, f"**{shown}**" if won.confirmed else shown])
    heads = ["family", "goal", "best option of the library", "winner of the race", "winner / library, fresh scenarios"]
    return markdown_table(heads, rows)


def _every(numbers: Numbers, goal: str, options: tuple[Option, ...]) -> list[Option]:
    """Return the options and their variants."""
    named = {option.name: option for option in options}
    variants = [
        Option(
            name=f"{name}-{parameter}{value:g}",
            configuration=named[name].configuration,
            score=0.0,
            parameters={**named[name].parameters, parameter: value},
        )
        for name, parameters in numbers.tried.get(goal, {}).items()
        if name in named
        for parameter, values in parameters.items()
        for value in values
    ]
    return [*options, *variants]


def _knowledge(place: Path, goals: Mapping[str, list[Option] | tuple[Option, ...]]) -> Path:
    content = {goal: [one.model_dump(mode="json") for one in options] for goal, options in goals.items()}
    return written(place.with_name(f"{place.name}.knowledge.yaml"), {"goals": content})


def _race(family: str, goals: str, knowledge: Path, output: Path, **sizes: int) -> None:
    if not (output / "summary.json").exists():
        race(family, goals, output, judged=2, knowledge=knowledge, **sizes)


def _best_and_known(place: Path, held: Mapping[str, str], goal: str, library: set[str]) -> tuple[str, str]:
    """Return what won a race, and the option of the library that was best beside it.

    Those that lasted longest come first, and of those the cheapest. An option of the library that dropped out before
    half of the scenarios were done does not count; the others are compared on the scenarios that they did.
    """
    column, costs = list(held).index(goal), dict[str, dict[str, float]]()
    for one in runs_of(place / JOURNAL):
        if one.scenario.startswith("train"):
            costs.setdefault(one.condition.split(JOINT)[column], {})[one.scenario] = one.result.excess_s
    best = min(costs, key=lambda name: (-len(costs[name]), float(np.mean(list(costs[name].values())))))
    won = costs[best]
    able = [name for name in costs if name in library and 2 * len(costs[name]) >= len(won)]

    def beside(name: str) -> float:
        return float(np.mean(list(costs[name].values())) / np.mean([won[scenario] for scenario in costs[name]]))

    return best, best if best in library else min(able, key=beside)


def _excesses(place: Path, options: Mapping[str, str]) -> np.ndarray:
    """Return the excess costs (K,) of options on all training scenarios."""
    name = JOINT.join(options.values())
    found = {one.scenario: one.result.excess_s for one in runs_of(place / JOURNAL) if one.condition == name}
    names = [scenario_name("train", k) for k in range(len(found))]
    return np.array([found[each] for each in names if each in found])
