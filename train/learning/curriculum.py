"""The scenarios of a training and of its validation, which follow from one seed.

Training uses the split "train" of a family with odd seeds, validation the same split with an even seed, and
`clean-swarm evaluate` the split "test": no scenario has two uses.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from itertools import count, groupby
from pathlib import Path

import numpy as np

from clean_swarm_env.config.families import FamilyConfig, Scenario
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.episodes import Size
from clean_swarm_env.learning.joined import batches_of
from selector.documents.errors import DocumentError
from selector.knowledge import Definition, check_same
from train.learning.config import TrainingConfig

TORI_TRIED = 200
"""Number of scenarios in which the tori of a family are searched."""
VALIDATION_SEED = 2
"""Seed of the validation scenarios, the same for all trainings, so that trainings can be compared."""


class Curriculum:
    """The worlds of a training and their scenarios.

    Attributes:
        batches: the worlds.
        definitions: goal -> option -> what its name stands for in all batches.
        validation: validation scenarios of each family.

    """

    def __init__(self, config: TrainingConfig, seed: int, directories: tuple[Path, ...] = (), threads: int = 1) -> None:
        """`threads` is the number of threads that step the worlds; they are the same with any."""
        self._seed = seed
        self._families = [task.load(directories) for task in config.tasks]
        for family in self._families:
            if family.mission.store:
                raise DocumentError(f"family {family.name}: mission.store: expected none in a training, see --store")
        self.batches: list[Batch] = []
        self._tori: list[list[Batch]] = []
        self.definitions: dict[str, dict[str, Definition]] = {}
        for family, task in zip(self._families, config.tasks, strict=True):
            own = batches_of(
                None,
                task.worlds,
                threads,
                sizes=_sizes(family),
                family=family,
                observation=config.observation,
                reward=given if isinstance(given := config.reward, str) else given.model_dump(exclude_unset=True),
                directories=directories,
            )
            self.batches += own
            self._tori += [list(alike) for _, alike in groupby(own, lambda batch: batch.mission.extent)]
        for model in (coordinator.model for batch in self.batches for coordinator in batch.worlds.coordinators):
            check_same("tasks", self.definitions, model.problem.definitions)
            self.definitions.setdefault(model.goal, {}).update(model.problem.definitions[model.goal])
        self.validation = {
            family.name: [family.scenario(VALIDATION_SEED, k, "train") for k in range(config.validation.scenarios)]
            for family in self._families
        }

    def set_scenarios(self, checkpoint: int) -> None:
        """Set the scenarios of the batches after a checkpoint, from their next reset on."""
        words = np.random.SeedSequence([self._seed, checkpoint, 1]).generate_state(len(self._tori), np.uint32)
        for torus, word in zip(self._tori, words, strict=True):
            first, worlds = 0, sum(batch.count for batch in torus)
            for batch in torus:
                batch.series.share(int(word) * 2 + 1, first, worlds)
                first += batch.count

    def scenarios(self, checkpoint: int) -> list[Iterator[Scenario]]:
        """Return for each family the endless series of scenarios after a checkpoint."""
        words = np.random.SeedSequence([self._seed, checkpoint, 4]).generate_state(len(self._families), np.uint32)
        drawn = zip(self._families, words, strict=True)
        return [map(partial(family.scenario, int(word) * 2 + 1, split="train"), count()) for family, word in drawn]


def _sizes(family: FamilyConfig) -> list[Size]:
    """Return the tori of a family in the order of the scenarios that have them."""
    scenarios = (family.scenario(VALIDATION_SEED, k, "train") for k in range(TORI_TRIED if len(family.tori) > 1 else 1))
    worlds = [scenario.mission.world for scenario in scenarios]
    return list(dict.fromkeys((world.width, world.height) for world in worlds))
