"""Scores of options after an advice: how well each served, beside the best on the same starts."""

from __future__ import annotations

from itertools import chain

import numpy as np

from clean_swarm_env.config.families import scenario_name
from clean_swarm_env.deciders.named import FIXED
from selector.documents.fields import JOINT
from selector.knowledge import LearnedScore, LearnedScores, Option
from train.advising.report import Advice
from train.advising.rounds import Round
from train.advising.search import held_by


def learned_from_rounds(advice: Advice) -> LearnedScores:
    """Return goal -> option -> the rewards of its missions.

    The mean of an option is that of the best, and by how much its own differed from it on the same starts in the
    last round in which both took part: rounds have other starts, and later ones better partners.
    """
    found: LearnedScores = {}
    names = [scenario_name("test", k) for k in range(advice.found.starts)]
    rewards = [advice.search.reward(advice.search.done[name, advice.found.winner]) for name in names]
    bases, table = held_by(advice.evaluation.opened, advice.found.leader), options_known(advice)
    for column, (goal, best) in enumerate(advice.held.items()):
        known = {one.name for one in table[goal]}
        own = {best: LearnedScore(count=len(rewards), mean=float(np.mean(rewards)), variance=float(np.var(rewards)))}
        for reference in dict.fromkeys((best, bases[goal])):  # rounds before that of the numbers lack a variant
            compared = dict(chain.from_iterable(_compared(one, column, reference) for one in advice.search.rounds))
            own = {
                name: LearnedScore(count=count, mean=own[reference].mean + less, variance=variance)
                for name, (count, less, variance) in compared.items()
                if name in known
            } | own
        found[goal] = own
    return found


def options_known(advice: Advice) -> dict[str, list[Option]]:
    """Return goal -> the options of the knowledge: those of the mission and of the library, and what is to be held."""
    held, varied = advice.held, advice.evaluation.varied
    best = {goal: [one for one in own if one.name == held[goal]] for goal, own in varied.items()}
    return {
        goal: [*own, *(one.model_copy(update={"score": 0.0}) for one in best.get(goal, ()))]
        for goal, own in advice.evaluation.opened.known.table.items()
    }


def _compared(done: Round, column: int, best: str) -> list[tuple[str, tuple[int, float, float]]]:
    """Return options with starts, by how much the mean reward differs from that of `best`, and the variance.

    Of several arms with an option the cheapest counts.
    """
    places: dict[str, int] = {}
    for place in done.means.argsort(kind="stable").tolist():
        kind, _, options = done.arms[place].partition(":")
        if kind == FIXED:
            places.setdefault(options.split(JOINT)[column], place)
    if best not in places or done.title == "choosers":
        return []
    reference = done.rewards[places[best]]
    return [
        (name, (len(reference), float((done.rewards[place] - reference).mean()), float(done.rewards[place].var())))
        for name, place in places.items()
        if name != best
    ]
