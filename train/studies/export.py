"""The result of a study as expert knowledge, in a file and in a knowledge store."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from clean_swarm_env.config.families import FamilyConfig
from clean_swarm_env.config.known import mission_context
from selector.documents.parameters import Content
from selector.documents.reading import as_yaml
from selector.knowledge import knowledge_from
from selforg.arrays import Floats
from train.evaluation.pipeline import mission_score
from train.knowledge_store import StoreRequest
from train.studies.conclusion import BEST_RANDOM, Conclusion
from train.studies.config import StudyConfig
from train.studies.missions import COST
from train.studies.space import StudySpace


class Export:
    """The knowledge that a study found: its results, the unchanged options and Off, with the scores of all.

    Args:
        study: the study.
        seed: its seed.
        family: the family whose missions gave the scores.
        space: the space of the study.
        conclusion: what came out.

    """

    def __init__(
        self, study: StudyConfig, seed: int, family: FamilyConfig, space: StudySpace, conclusion: Conclusion
    ) -> None:
        self._study, self._seed, self._family, self._space = study, seed, family, space
        self._conclusion = conclusion
        self._scores: dict[tuple[str, str], Floats] = {}
        self._goals: dict[str, list[Content]] = {}
        others = [one for one in conclusion.yardsticks if one.label != BEST_RANDOM]
        for goal in space.goals:
            options: dict[str, Content] = {}
            for stated in (*conclusion.results, *others):
                option = space.served(stated.candidate.goals)[goal]
                name = stated.label if stated in conclusion.results else str(option["name"])
                costs = stated.figures[COST].tolist()
                scores = np.array([mission_score(family.mission, cost) for cost in costs])
                self._scores.setdefault((goal, name), scores)
                options.setdefault(name, {**option, "name": name, "score": round(float(scores.mean()), 6)})
            self._goals[goal] = list(options.values())

    def text(self) -> str:
        """Return the file `knowledge/NAME.yaml`."""
        return as_yaml({"description": self._description(), "goals": self._all_goals(), "learned": self._learned()})

    def give(self, request: StoreRequest) -> None:
        """Give the options and their scores to a store, with the study as their source, once."""
        knowledge = knowledge_from({"goals": self._all_goals()}, self._study.name)
        source = f"study {self._study.name}, seed {self._seed}"
        memory = request.memory(knowledge, mission_context(self._family.name), source)
        if memory is None:
            return
        if not memory.given():
            memory.give((goal, name, float(x)) for (goal, name), scores in self._scores.items() for x in scores)
        memory.close()

    def _all_goals(self) -> dict[str, list[Content]]:
        return {**self._conclusion.results[0].candidate.goals, **self._goals}

    def _learned(self) -> Mapping[str, Mapping[str, Content]]:
        learned: dict[str, dict[str, Content]] = {goal: {} for goal in self._space.goals}
        for (goal, name), scores in self._scores.items():
            figures = {"count": len(scores), "mean": float(scores.mean()), "variance": float(scores.var())}
            learned[goal][name] = figures
        return learned

    def _description(self) -> str:
        study, lines = self._study, []
        for stated in self._conclusion.results:
            cost = stated.summaries["cost_s"]
            interval = "" if cost.ci95 is None else f" [{cost.ci95[0]:.1f}, {cost.ci95[1]:.1f}]"
            lines.append(
                f"{stated.label} costs {cost.mean:.1f} s{interval} on {stated.figures.shape[1]} fresh scenarios"
            )
            lines[-1] += marked(self._conclusion.marks(stated))
        about = f"{study.method} on training scenarios of {self._family.name}, seed {self._seed}"
        return f"{study.description} {about}: {'; '.join(lines)}.".strip()


def marked(marks: Sequence[str]) -> str:
    """Return the mark of a result that does not beat what it had to beat; empty without such."""
    return f", NOT SHOWN TO BEAT {' AND '.join(marks)}" if marks else ""
