"""A comparison: conditions on the scenarios of a document, and all else that its runs depend on.

Its manifest is plain data by a stranger, of which nothing is run or imported here.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Annotated, Any, NamedTuple, Self

from pydantic import BaseModel, ConfigDict, Field

from clean_swarm_env.config.experiment import GivenStarts
from clean_swarm_env.config.families import FamilyConfig, Scenario
from clean_swarm_env.config.mission import OptionScores
from clean_swarm_env.deciders.named import decider_named, without_digest
from selector.documents.errors import validated
from selector.documents.fields import Closed
from train.running.run_folder import MANIFEST, Json
from train.running.runs import RunKey, under
from train.running.trial_task import TrialTask


class Deciders(Closed):
    """What runs under one label of all results."""

    members: Annotated[tuple[str, ...], Field(min_length=1)]
    """What decides, as `decider_named` takes it: one for each seed of a training, or the strategy alone."""
    scores: OptionScores = Field(default={})
    """Goal -> option -> score, in place of those of the mission."""

    def names(self, label: str) -> tuple[str, ...]:
        """Return the names under which the runs of the members are kept."""
        several = len(self.members) > 1
        return tuple(f"{label}#{k + 1}" if several else label for k in range(len(self.members)))


class RunBasis(NamedTuple):
    """What the runs of one name depend on, beside the scenario."""

    variant: str
    member: str
    """With the digest of its file."""
    scores: OptionScores


class Comparison(BaseModel):
    """Conditions on scenarios, in each variant of the document that scenarios are drawn from."""

    model_config = ConfigDict(frozen=True)

    document: FamilyConfig | GivenStarts
    """What scenarios are drawn from, with its variants."""
    seed: Annotated[int, Field(strict=True, ge=0)]
    """Seed of everything random."""
    goal: str
    """Goal that deciders choose options for."""
    asked: bool = False
    """Whether the goal was asked for: then those decide it, too, that were made for others."""
    conditions: Mapping[str, Deciders]
    """Label -> what runs; the members have the digests of their files."""
    files: Mapping[str, str] = Field(default={})
    """File on which runs depend -> its digest."""
    directories: tuple[Path, ...] = ()
    """The user's own directories of configurations."""

    @classmethod
    def read(cls, manifest: Json, directory: Path) -> Self:
        """Return the comparison in the manifest of a directory; an error of one line for a mistake in it."""
        identity, where = manifest["identity"], f"{directory / MANIFEST}: identity"
        content = identity.get("document")
        kind = FamilyConfig if isinstance(content, dict) and "robots" in content else GivenStarts
        document = validated(kind, content, f"{where}.document")
        beside = {"document": document, "directories": manifest.get("directories", ())}
        return validated(cls, {**identity, **beside}, where)

    @property
    def identity(self) -> dict[str, Any]:
        """What the manifest has, from which `read` makes the comparison; without the places of the user's files."""
        kind = FamilyConfig if isinstance(self.document, FamilyConfig) else GivenStarts
        document = self.document.model_dump(mode="json", include=set(kind.model_fields) - {"strategies"})
        return {**self.model_dump(mode="json", exclude={"document", "directories"}), "document": document}

    @property
    def bases(self) -> dict[str, RunBasis]:
        """Name under which runs are kept -> what they depend on."""
        return {
            under(variant, name): RunBasis(variant, member, one.scores)
            for variant in self.document.variants
            for label, one in self.conditions.items()
            for name, member in zip(one.names(label), one.members, strict=True)
        }

    def tasks(
        self, scenarios: Sequence[str], done: Collection[RunKey] = (), names: Sequence[str] = ()
    ) -> list[TrialTask]:
        """Return the tasks for all runs that are not `done`, or for those that are kept under `names`."""
        variants, found = self.document.variants, list[TrialTask]()
        drawn = cache(lambda variant, name: variants[variant].scenario_named(self.seed, name))
        for name, (variant, member, scores) in self.bases.items():
            if not names or name in names:
                text = without_digest(member)
                goal = self.goal if self.asked or not decider_named(text, self.directories).goals else ""
                missing = [_scored(drawn(variant, one), scores) for one in scenarios if (one, name) not in done]
                own = (self.document.name, self.seed, tuple(missing), name, text, goal)
                found += TrialTask(*own, directories=self.directories).parts()
        return found


def _scored(scenario: Scenario, scores: OptionScores) -> Scenario:
    """Return a scenario with scores of options in place of those of its mission."""
    if not scores:
        return scenario
    changes = {"scores": {**scenario.mission.scores, **scores}}
    return replace(scenario, mission=scenario.mission.model_copy(update=changes))
