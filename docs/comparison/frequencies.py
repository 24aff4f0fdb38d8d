"""How often robots of the claimed learner take each option, by family and by the state of the world.

No robot sees that state: where garbage falls, and whether collisions are harmless. A fixed choice with one switch would
show as two rows of single options. Of exploration only decisions count whose behaviour then ran.
"""

from collections import Counter, defaultdict
from pathlib import Path

from clean_swarm_env.config.families import Scenario, scenario_name
from clean_swarm_env.config.types import AVOIDANCE
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.tasks.cleaning.task import cleaning_of
from docs.comparison.manifest import Manifest
from docs.comparison.runs import claimed_training
from selector.documents.fields import JOINT
from selector.documents.writing import write_whole
from train.deciders.named import POLICY
from train.evaluation.family import FamilyEvaluation
from train.reports.text_table import markdown_table
from train.request import Request

MISSIONS, SHOWN = 4, 3
"""Test missions of each family, and options of a goal that are named."""


def frequencies_table(manifest: Manifest, folder: Path) -> str:
    """Return a row for each family and case; the table is kept in the directory of the results."""
    kept = folder / "frequencies.md"
    if kept.exists():
        return kept.read_text(encoding="utf-8")
    rows, goals = [], manifest.goal.split(JOINT)
    for family in manifest.families:
        taken = _taken(manifest, folder, family)
        for case in sorted({case for case, _ in taken}):
            cells = [shares_of(taken[case, goal], SHOWN) for goal in goals]
            rows.append([f"`{family}`", case, *cells])
    table = markdown_table(["family", "garbage, collisions", *goals], rows)
    write_whole(kept, table.encode())
    return table


def _taken(manifest: Manifest, folder: Path, family: str) -> dict[tuple[str, str], Counter[str]]:
    """Return case and goal -> option -> how often robots took it."""
    goal = manifest.goal_on(family)
    asked = Request(
        family, strategies=(f"{POLICY}:{claimed_training(manifest, folder)}",), seed=manifest.seeds[0], goal=goal
    )
    evaluation, found = FamilyEvaluation(asked), defaultdict[tuple[str, str], Counter[str]](Counter)
    for number in range(MISSIONS):
        _count(evaluation, evaluation.scenario(evaluation.family, scenario_name("test", number)), found)
    return found


def _count(evaluation: FamilyEvaluation, scenario: Scenario, found: dict[tuple[str, str], Counter[str]]) -> None:
    """Count the options of one mission."""
    waiting = iter([scenario])
    task = evaluation.task([scenario], "", evaluation.entrants[0].members[0])
    batch, decided, decider = task.team(source=lambda _: next(waiting, None))
    seen = batch.reset()
    decider.reset(slice(None), scenario.seed)  # type: ignore[arg-type]
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
    cleaning = cleaning_of(batch.worlds.task)
    where = "at spots" if cleaning.comings.at_spots[0] else "anywhere"
    return where + (", harmless" if cleaning.consequences.harmless[0] else "")


def shares_of(taken: Counter[str], most: int) -> str:
    """Return the options that were taken most often, with their shares."""
    return ", ".join(f"{option} {number / taken.total():.0%}" for option, number in taken.most_common(most))
