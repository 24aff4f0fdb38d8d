"""How often robots of the claimed strategy take each option, by family and by the state of the world.

No robot sees that state: where garbage falls, and whether collisions are harmless. A fixed choice with one switch would
show as two rows of single options. Of exploration only decisions count whose behaviour then ran.
"""

from collections import Counter, defaultdict

import numpy as np

from clean_swarm_env.config.families import scenario_name
from clean_swarm_env.config.types import AVOIDANCE
from clean_swarm_env.learning.batch import Batch
from docs.comparison.manifest import Manifest
from docs.comparison.missions import family_of
from selector.documents.fields import JOINT
from train.reports.text_table import markdown_table
from train.running.trial_task import TrialTask

MISSIONS, SHOWN = 4, 3
"""Test missions of each family, and options of a goal that are named."""


def frequencies_table(manifest: Manifest) -> str:
    """Return a row for each family and case."""
    rows, goals = [], manifest.goal.split(JOINT)
    for family in manifest.families:
        found = defaultdict[tuple[str, str], Counter[str]](Counter)
        for number in range(MISSIONS):
            _count(manifest, family, number, found)
        for case in sorted({case for case, _ in found}):
            rows.append([f"`{family}`", case, *(shares_of(found[case, goal], SHOWN) for goal in goals)])
    return markdown_table(["family", "garbage, collisions", *goals], rows)


def _count(manifest: Manifest, family: str, number: int, found: dict[tuple[str, str], Counter[str]]) -> None:
    """Count the options of one test mission of a family: case and goal -> option -> how often robots took it."""
    given = family_of(family, manifest.families[family])
    scenario = given.scenario_named(manifest.seed, scenario_name("test", number))
    waiting, goal = iter([scenario]), manifest.families[family].goal or manifest.goal
    member = manifest.strategies[manifest.claimed]
    task = TrialTask(given.name, manifest.seed, (scenario,), manifest.claimed, member, goal)
    batch, decided, decider = task.team(source=lambda _: next(waiting, None))
    seen = batch.reset()
    decider.reset(np.arange(batch.rows), scenario.seed)
    while not batch.finished:
        case, actions = _case(batch), decided.decide(decider, seen)
        seen = batch.step(actions).observations
        for column in decided.columns:
            goal = list(batch.options)[column]
            ran = batch.took_part & (batch.progress.acted[:, column] | (goal == AVOIDANCE))  # steering needs none
            names = [batch.options[goal][option] for option in actions[ran, column]]
            found[case, goal].update(names)


def _case(batch: Batch) -> str:
    """Return the state of the first world: where garbage falls, and whether collisions are harmless."""
    cleaning = batch.worlds.task
    where = "at spots" if cleaning.comings.at_spots[0] else "anywhere"
    return where + (", harmless" if cleaning.consequences.harmless[0] else "")


def shares_of(taken: Counter[str], most: int) -> str:
    """Return the options that were taken most often, with their shares."""
    return ", ".join(f"{option} {number / taken.total():.0%}" for option, number in taken.most_common(most))
