"""What a decider thinks of the options, as expert knowledge: its mean opinions in each situation of a robot.

Shapes: S situations, O options, R robots.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from clean_swarm_env.config.families import Scenario, scenario_name
from clean_swarm_env.config.known import knowledge_of
from clean_swarm_env.config.types import ConfigurationError
from selector.documents.fields import JOINT
from selector.knowledge import Knowledge
from selforg.arrays import Floats
from train.deciders.decider import columns_of
from train.deciders.named import decider_named
from train.evaluation.family import FamilyEvaluation
from train.request import Request


def knowledge_of_decider(request: Request, situations: Sequence[str]) -> tuple[Knowledge, int]:
    """Return the knowledge of a family with the opinions of a decider as scores, and the number of its decisions.

    Only decisions count in which the robot then ran the option. Where a situation never occurred, the scores over all
    situations stand.

    Args:
        request: the family, one strategy, the number of training scenarios, and perhaps the goal.
        situations: components of the observation; the largest one gives the situation of a robot.

    Raises:
        DocumentError: the decider does not exist or fit, or a component is unknown.
        ConfigurationError: the decider drives, or decides for several goals at once, or no robot ran an option.

    """
    named = decider_named(request.strategies[0], request.directories)
    if named.mode != "option":
        raise ConfigurationError(f"{named.text}: expected a decider that only chooses options, got one that drives")
    asked = named.decides(request.goal)
    goals = asked if asked is None or isinstance(asked, str) else JOINT.join(asked)
    evaluation = FamilyEvaluation(replace(request, goal=goals))
    goal, known = evaluation.goal, knowledge_of(evaluation.mission, request.directories)
    if goal not in known.goals:
        raise ConfigurationError(f"{named.text}: expected a decider for one goal, got one for {goal}")
    scenarios = [
        evaluation.scenario(evaluation.family, scenario_name("train", k)) for k in range(request.scenarios or 1)
    ]
    sums = np.sum([_opinions_on(evaluation, scenario, situations) for scenario in scenarios], axis=0)
    total = np.sum(sums, axis=0)
    if not total[-1]:
        raise ConfigurationError(f"{request.name}: expected robots that run options of {goal}, got none")
    means = np.where(sums[:, -1:] > 0.0, sums, total)
    scores = [dict(zip(evaluation.options, (row[:-1] / row[-1]).tolist(), strict=True)) for row in (total, *means)]
    found = known.with_scores({goal: scores[0]})
    return found.with_situations({goal: dict(zip(situations, scores[1:], strict=True))}), int(total[-1])


def _opinions_on(evaluation: FamilyEvaluation, scenario: Scenario, situations: Sequence[str]) -> Floats:
    """Return the sums of the opinions, and the number of decisions, in each situation (S, O + 1) of one mission."""
    waiting = iter([scenario])
    task = evaluation.task([scenario], "", evaluation.entrants[0].members[0])
    batch, decided, decider = task.team(source=lambda _: next(waiting, None))
    columns = columns_of(decided.problem, tuple(situations), "--situations")
    sums, seen = np.zeros((len(situations), len(evaluation.options) + 1)), batch.reset()
    decider.reset(np.arange(batch.rows), scenario.seed)
    while not batch.finished:
        actions, place = decided.decide(decider, seen), seen[:, columns].argmax(axis=1)
        thought = np.hstack([decider.opinions(), np.ones((batch.rows, 1))])
        seen = batch.step(actions).observations
        ran = batch.took_part & batch.progress.acted[:, decided.columns].any(axis=1)
        np.add.at(sums, place[ran], thought[ran])
    return sums
