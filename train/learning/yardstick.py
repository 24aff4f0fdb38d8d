"""What a training has to beat: the best fixed options on its validation missions, told while it trains.

The best are chosen on a few validation scenarios and measured on all of them.

Shapes: K validation scenarios of a family.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field

from clean_swarm_env.config.families import Scenario
from clean_swarm_env.deciders.decided_goal import option_named
from clean_swarm_env.deciders.decider import Decider, DeciderMaker
from clean_swarm_env.deciders.strategies import StrategyDecider
from clean_swarm_env.world.mission import MissionResult
from selector.documents.errors import shown, validated
from selector.documents.fields import JOINT, Closed, Number
from selector.documents.reading import json_value, read_text
from selector.strategies.problem import Problem
from selector.strategies.registry import StrategySpec
from selforg.arrays import Ints
from train.running.trials import TrialSettings, run_trials

VALIDATION_FILE = "validation.json"
SCORED_HIGHEST = "options of highest score"
"""What the yardstick is called that holds what experts score highest."""
TRIED_SCENARIOS = 4
"""Validation scenarios of each family on which the best options are chosen."""
MOST_OPTIONS = 12
"""Most options that are all tried; of more, those of highest score and those with which the training starts."""

ByFamily = Mapping[str, Sequence[Scenario]]
"""Family -> its validation scenarios."""
Results = Mapping[str, Sequence[MissionResult]]
Excesses = dict[str, list[float]]
"""Family -> (K,) excess of each validation mission [s]."""


class Validation(Closed):
    """The excess of the best checkpoint on the validation missions, and of the yardstick."""

    learned: Annotated[dict[str, Annotated[list[Number], Field(min_length=1)]], Field(min_length=1)]
    """Family -> (K,) of the best checkpoint [s]."""
    yardstick: Annotated[dict[str, Annotated[list[Number], Field(min_length=1)]], Field(min_length=1)]
    """Family -> (K,) of the best fixed options [s]."""
    held: str
    """The best fixed options."""


def results_on(scenarios: ByFamily, maker: DeciderMaker, settings: TrialSettings) -> dict[str, list[MissionResult]]:
    """Return the results of the missions of each family."""
    return {family: run_trials(some, maker, settings) for family, some in scenarios.items()}


def excesses(results: Results) -> Excesses:
    """Return the excess of each mission."""
    return {family: [result.excess_s for result in own] for family, own in results.items()}


def best_fixed(
    scenarios: ByFamily, problem: Problem, start: Sequence[str], settings: TrialSettings
) -> tuple[str, Excesses]:
    """Return the fixed options of the lowest excess, and their excess on all scenarios.

    Args:
        scenarios: the validation scenarios.
        problem: goals and options of one family; others may lack some of them.
        start: options with which the training starts; empty for none.
        settings: of trials in which options are chosen.

    """
    choices = [option.split(JOINT) for option in problem.options]
    if len(choices) > MOST_OPTIONS:
        choices = [[], *([list(start)] if start else [])]
    first = {family: some[:TRIED_SCENARIOS] for family, some in scenarios.items()}
    means = [mean_excess(excesses(results_on(first, partial(_held, held), settings))) for held in choices]
    best = choices[int(np.argmin(means))]
    return JOINT.join(best) or SCORED_HIGHEST, excesses(results_on(scenarios, partial(_held, best), settings))


def _held(options: Sequence[str], problem: Problem, teams: Ints) -> Decider:
    """Return what always takes those of the options that a problem has, and by score where it has none of them."""
    known = {name for option in problem.options for name in option.split(JOINT)}
    wanted = [name for name in options if name in known]
    best = option_named(problem, JOINT.join(wanted)) if wanted else problem.options[int(np.argmax(problem.scores))]
    return StrategyDecider(StrategySpec(name="Fixed", parameters={"option": best}), problem, teams)


def mean_excess(found: Excesses) -> float:
    """Return the mean excess, in which families count alike."""
    return float(np.mean([np.mean(own) for own in found.values()]))


def validation_in(folder: Path) -> Validation | None:
    """Return what a directory of a training holds; DocumentError for a damaged file."""
    file = folder / VALIDATION_FILE
    return validated(Validation, json_value(read_text(file), shown(file)), shown(file)) if file.exists() else None


def beside_yardstick(validation: Validation) -> str:
    """Return in words what the best checkpoint and the yardstick lose, for a progress bar."""
    learned, held = mean_excess(validation.learned), mean_excess(validation.yardstick)
    return f"best so far: excess {learned:,.0f} s a validation mission, {validation.held} {held:,.0f} s"
