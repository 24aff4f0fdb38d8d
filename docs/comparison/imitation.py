"""Imitation of told teams: rounds of whole missions, in each of which robots are told what a told team would hold.

In the first round told teams do the missions, later the network that has learned so far: it meets what its own choices
lead to (DAgger: Ross, Gordon & Bagnell 2011, arXiv 1011.0686). It learns from what robots observe, by cross entropy;
families count alike. Where nothing tells the kinds of scenarios apart yet, its options are as likely as these kinds.

Shapes: W worlds, R rows (robots), F components of an observation, G goals, O options of all goals, K decisions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import islice, pairwise
from pathlib import Path

import numpy as np
import torch
from torch.nn.functional import cross_entropy

from clean_swarm_env.config.families import Scenario
from clean_swarm_env.config.frames import grouped
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.deciders.decided_goal import DecidedGoal
from clean_swarm_env.deciders.strategies import PolicyDecider
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.joined import Joined
from clean_swarm_env.learning.observation.config import TermConfig
from docs.comparison.manifest import Imitation, Manifest, Taught
from docs.comparison.missions import SEASON, scenario_kinds
from selector.documents.fields import JOINT
from selector.strategies.policy_file import PolicySpec, TrainedPolicy, save_policy
from selector.strategies.probing import Probing
from selforg.arrays import Floats, Ints
from selforg.registry import unknown
from train.learning.config import PpoConfig, TrainingConfig
from train.learning.curriculum import Curriculum

EVERY = 4
"""Decision periods from one decision that is learned from to the next."""
STEPS, BATCH, RATE = 2000, 1024, 3e-3
"""Gradient steps of a round, decisions of each, and step size of Adam at first; it falls to a hundredth."""


class Lesson:
    """What a network learns on one family.

    Args:
        taught: what a told team holds there.
        config: goals and observation.
        options: goal -> names of the options of all families.
        names: (F,) components of the observation that the network sees.

    Attributes:
        seen, labels: (K, F) observations, and (K, G) the numbers of the options that a told team holds there.

    """

    def __init__(
        self, taught: Taught, config: TrainingConfig, options: Mapping[str, Sequence[str]], names: Sequence[str]
    ) -> None:
        self._taught, self._options, self._names = taught, options, names
        terms = (*(config.observation.terms or ()), *[TermConfig(name=SEASON)] * bool(taught.told_by))
        self._observation = config.observation.model_copy(update={"terms": terms})
        self.seen = np.zeros((0, len(names)), dtype=np.float32)
        self.labels = np.zeros((0, len(options)), dtype=np.int64)

    def learn(self, scenarios: Sequence[Scenario], policy: TrainedPolicy | None) -> None:
        """Let a policy do missions, or told teams without one, and keep what a told team would hold in them."""
        for numbers in grouped([scenario.mission for scenario in scenarios]):
            self._do([scenarios[number] for number in numbers], policy)

    def _do(self, scenarios: Sequence[Scenario], policy: TrainedPolicy | None) -> None:
        """Do missions of one frame side by side, one in each world."""
        waiting = [iter([scenario]) for scenario in scenarios]
        batch = Batch(
            scenarios[0].mission,
            len(scenarios),
            source=lambda world: next(waiting[world], None),
            observation=self._observation,
        )
        decided, observations = DecidedGoal(batch, JOINT.join(self._options)), batch.reset()
        team_of = np.repeat(np.arange(batch.count), batch.robots)
        decider = policy and PolicyDecider(policy, decided.problem, team_of)
        for world, scenario in enumerate(scenarios if decider is not None else ()):
            decider.reset(batch.worlds.rows_of(world), scenario.seed)
        kinds = [self._taught.told.get(kind, self._taught.fixed[0]) for kind in scenario_kinds(scenarios)]
        told = np.array([decided.number_of(name) for name in self._taught.told_by.values() or kinds])
        seasons = [batch.observer.names.index(name) for name in self._taught.told_by]
        period = 0
        while not batch.over.all():
            right = told[observations[:, seasons].argmax(axis=1) if seasons else team_of]
            if period % EVERY == 0:
                working = np.flatnonzero(batch.working & ~batch.over[team_of])
                self._keep(observations[working], right[working], decided)
            options = right if decider is None else decider.decide(observations).options
            observations, period = batch.step(decided.actions(options)).observations, period + 1

    def _keep(self, observations: Floats, right: Ints, decided: DecidedGoal) -> None:
        """Keep what robots observe and the options (K,) that are right there."""
        columns = [decided.problem.features.index(name) for name in self._names]
        labels = [
            np.array([names.index(name) for name in own])[numbers]
            for names, own, numbers in zip(
                self._options.values(), decided.parts, decided.combined(right).T, strict=True
            )
        ]
        self.seen = np.vstack([self.seen, observations[:, columns]])
        self.labels = np.vstack([self.labels, np.stack(labels, axis=1)])


def imitate(manifest: Manifest, asked: Imitation, config: TrainingConfig, seed: int, output: Path) -> None:
    """Train a network, and export it to the directory `policy` in `output`; equal seeds make equal files."""
    torch.set_num_threads(1)
    settings, narrow = config.ppo or PpoConfig(), [task.model_copy(update={"worlds": 1}) for task in config.tasks]
    curriculum = Curriculum(config.model_copy(update={"tasks": narrow}), seed)
    every, observer = Joined(curriculum.batches).options, curriculum.batches[0].observer
    options = {goal: every[goal] for goal in (config.goal or manifest.goal).split(JOINT)}
    for family in curriculum.validation:
        if family not in manifest.seen:
            raise ConfigurationError(f"seen: {config.name} sees an {unknown('family', family, [*manifest.seen])}")
    lessons = [Lesson(manifest.seen[family], config, options, observer.names) for family in curriculum.validation]
    spec = PolicySpec(
        goals=options,
        definitions={goal: curriculum.definitions[goal] for goal in options},
        holds={goal: periods for goal, periods in settings.holds.items() if goal in options},
        observation=observer.config.model_dump(mode="json"),
        observations=observer.names,
        hidden=asked.hidden,
        mean=(0.0,) * observer.width,
        variance=(1.0,) * observer.width,
        probing=Probing(sampled=settings.plays == "sampled"),
        training={"seed": seed, "configuration": config.model_dump(mode="json")},
    )
    policy = None
    for number in range(asked.rounds):
        for lesson, scenarios in zip(lessons, curriculum.scenarios(number), strict=True):
            lesson.learn(list(islice(scenarios, asked.scenarios)), policy)
        policy = fitted(spec, lessons, seed)
        save_policy(output / "policy", policy)


def fitted(spec: PolicySpec, lessons: Sequence[Lesson], seed: int) -> TrainedPolicy:
    """Return a policy with the network that fits the lessons, and with the statistics of what was observed."""
    seen, labels = (np.concatenate([getattr(one, name) for one in lessons]) for name in ("seen", "labels"))
    shares = np.concatenate([np.full(len(one.seen), 1.0 / len(one.seen) / len(lessons)) for one in lessons])
    mean = shares @ seen
    variance = shares @ (seen - mean) ** 2
    normal = np.clip((seen - mean) / np.sqrt(variance + spec.epsilon), -spec.clip, spec.clip).astype(np.float32)
    inputs, wanted, worth = torch.as_tensor(normal), torch.as_tensor(labels), torch.as_tensor(shares * len(seen))
    torch.manual_seed(seed)
    widths, counts = (seen.shape[1], *spec.hidden), [len(names) for names in spec.goals.values()]
    hidden, options = [torch.nn.Linear(*pair) for pair in pairwise(widths)], torch.nn.Linear(widths[-1], sum(counts))
    network = torch.nn.Sequential(*(part for layer in hidden for part in (layer, torch.nn.Tanh())), options)
    optimizer = torch.optim.Adam(network.parameters(), lr=RATE)
    schedule = torch.optim.lr_scheduler.LinearLR(optimizer, 1.0, 0.01, STEPS)
    for _ in range(STEPS):
        chosen = torch.randint(len(seen), (BATCH,))
        parts = network(inputs[chosen]).split(counts, dim=1)
        each = [cross_entropy(part, wanted[chosen, k], reduction="none") for k, part in enumerate(parts)]
        loss = (torch.stack(each).sum(dim=0) * worth[chosen]).mean()
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        schedule.step()
    print(f"imitation {seed}: {len(seen)} decisions, loss {loss.item():.3f}", flush=True)
    named = {f"hidden.{k}": layer for k, layer in enumerate(hidden)} | {"options": options}
    weights = {
        f"{name}.{part}": getattr(layer, part).detach().numpy()
        for name, layer in named.items()
        for part in ("weight", "bias")
    }
    statistics = {"mean": tuple(mean.tolist()), "variance": tuple(variance.tolist())}
    known = {**statistics, "training": {**spec.training, "decisions": len(seen)}}
    return TrainedPolicy(spec.model_copy(update=known), weights)
