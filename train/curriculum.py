"""Which scenarios are trained on and which are only measured on, from one seed.

Training takes the split "train" of a family with odd seeds, measuring during the training the same split with an even
one, and `clean-swarm evaluate` the split "test": no scenario is ever one of another use.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from clean_swarm_env.config_files import load_family
from clean_swarm_env.families import FamilyConfig, Scenario
from clean_swarm_env.frames import frame_of
from train.scenario_worlds import JoinedWorlds, ScenarioBatch, Source
from train.training_config import TrainingConfig

FRAMES_TRIED = 200
"""Scenarios from which the frames of a family are gathered."""
VALIDATION_SEED = 2
"""Seed of the scenarios that are measured on, the same for all trainings, so that they can be compared."""


class Curriculum:
    """The worlds of a training and what they do between two checkpoints.

    Attributes:
        joined: the worlds.
        validation: scenarios of each family that are measured on.

    """

    def __init__(self, config: TrainingConfig, seed: int, directories: tuple[Path, ...] = ()) -> None:
        self._seed = seed
        self._parts: list[tuple[FamilyConfig, int, int]] = []  # family, first world within it, worlds of the family
        batches = []
        for task in config.tasks:
            family = load_family(task.family, directories)
            frames = _frames(family)
            for k, frame in enumerate(frames):
                worlds = len(range(k, task.worlds, len(frames)))
                if worlds:
                    batches.append(
                        ScenarioBatch(
                            frame.mission, worlds, lambda _: None, observation=config.observation,
                            reward=config.reward, directories=directories,
                        )
                    )  # fmt: skip
                    self._parts.append((family, k, len(frames)))
        self.joined = JoinedWorlds(batches)
        self._check_options(batches)
        self.validation = {
            family.name: [family.scenario(VALIDATION_SEED, k, "train") for k in range(config.validation.scenarios)]
            for family in (load_family(task.family, directories) for task in config.tasks)
        }

    def sources(self, checkpoint: int) -> list[Source]:
        """Return what the batches do from a checkpoint on; it depends on the seed and the checkpoint only."""
        words = np.random.SeedSequence([self._seed, checkpoint, 1]).generate_state(len(self._parts), np.uint32)
        return [
            _source(family, batch, int(word) * 2 + 1)
            for (family, _, _), batch, word in zip(self._parts, self.joined.batches, words, strict=True)
        ]

    def _check_options(self, batches: Sequence[ScenarioBatch]) -> None:
        first = batches[0]
        for batch in batches[1:]:
            if batch.options != first.options or batch.observer.names != first.observer.names:
                raise ValueError("tasks: expected families with the same expert knowledge")


def _frames(family: FamilyConfig) -> list[Scenario]:
    """Return one scenario of each frame of a family."""
    found: list[Scenario] = []
    for index in range(FRAMES_TRIED if family.sizes else 1):
        scenario = family.scenario(VALIDATION_SEED, index, "train")
        if all(frame_of(known.mission) != frame_of(scenario.mission) for known in found):
            found.append(scenario)
    return found


def _source(family: FamilyConfig, batch: ScenarioBatch, seed: int) -> Source:
    """Return what a batch does: world w of W does the scenarios w, w + W, ... of a seed that fit its frame."""
    worlds = batch.worlds.worlds
    following = list(range(worlds))
    frame = frame_of(batch.mission)

    def next_scenario(world: int) -> Scenario:
        while True:
            scenario = family.scenario(seed, following[world], "train")
            following[world] += worlds
            if not family.sizes or frame_of(scenario.mission) == frame:
                return scenario

    return next_scenario
