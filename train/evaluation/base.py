"""Evaluations: the base class of those of an experiment and of a family, and what their manifests say.

A manifest is plain data by a stranger, of which nothing is run or imported here.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import fmean
from typing import Annotated, Any, Self

from pydantic import BaseModel, ConfigDict, Field

from clean_swarm_env.config.families import FamilyConfig, RobustnessConfig
from clean_swarm_env.config.mission import MissionConfig
from selector.documents.errors import validated
from train.evaluation.entrants import Entrant
from train.evaluation.scenarios import variants_of
from train.memory import Memory, as_plain
from train.reports.text_table import Publication
from train.request import Request
from train.running.run_folder import LEARNED_BEFORE, MANIFEST, Json, fingerprints, versions
from train.running.runs import RunKey, RunRecord, under
from train.running.trial_task import TrialTask

DIGEST = " sha256:"
"""What follows a member that names a file in the manifest."""


class Identity(BaseModel):
    """The identity of an evaluation of an experiment or of a family."""

    model_config = ConfigDict(frozen=True)

    seed: Annotated[int, Field(strict=True, ge=0)]
    """Seed of the evaluation."""
    directories: tuple[Path, ...] = ()
    """The user's own directories of configurations."""
    goal: str = ""
    """Goal that strategies chose options for."""
    strategies: Mapping[str, tuple[str, ...]] = Field(default={})
    """Label of a strategy -> its members, with the digests of their files."""
    deciders: Mapping[str, str] = Field(default={})
    """Condition of an experiment -> its decider, with the digest of its file."""
    files: Mapping[str, str] = Field(default={})
    """File on which runs depend -> its digest."""
    configuration: Any = None
    """Document of the experiment; None of a family."""
    on: Any = Field(default=None, alias="family")
    """Document of the family; None of an experiment."""

    @classmethod
    def of(cls, manifest: Json, directory: Path) -> Self:
        """Return the identity in the manifest of a directory; an error of one line for a mistake in it."""
        further = {key: manifest[key] for key in ("directories",) if key in manifest}
        return validated(cls, {**further, **manifest["identity"]}, f"{directory / MANIFEST}: identity")

    @property
    def entrants(self) -> list[Entrant]:
        """The strategies, whose members have no digests."""
        return [
            Entrant(label, tuple(member.partition(DIGEST)[0] for member in members))
            for label, members in self.strategies.items()
        ]

    def family(self, directory: Path) -> FamilyConfig:
        """Return the family, with disturbances where it has them."""
        where = f"{directory / MANIFEST}: identity.family"
        if isinstance(self.on, dict) and "disturbances" in self.on:
            return validated(RobustnessConfig, self.on | {"strategies": list(self.strategies)}, where)
        return validated(FamilyConfig, self.on, where)

    def runs(self, family: FamilyConfig) -> dict[str, tuple[FamilyConfig, str]]:
        """Return condition -> variant of the family, and member with its digest; see `variants_of`."""
        return {
            under(name, condition): (variant, member)
            for name, variant in variants_of(family).items()
            for entrant, members in zip(self.entrants, self.strategies.values(), strict=True)
            for condition, member in zip(entrant.conditions, members, strict=True)
        }


Done = Mapping[RunKey, RunRecord]
"""Runs that need not be done."""


class Evaluation(ABC):
    """Base class of evaluations, which define runs and a report on them.

    The constructor gets the user's request, and raises an error of one line, before anything is written, for everything
    that does not exist or fit.

    Attributes:
        request: the request.
        directories: the user's own directories of configurations.
        stem: name of the default directory for the results.
        manifest: content of `manifest.json`; `identity` decides whether runs can be resumed, the rest is for readers.
        growing: name of a mapping in the identity to which entries can be added later; empty: none.
        memory: the knowledge store of this evaluation, if any.
        mission: the mission; before the runs begin it gets what was learned of its options.
        scenarios: names of the scenarios, in the order in which missions learn.
        context: under which a store keeps rewards of such missions.
        so_far: what is known before all runs are done, which follows how many are kept.

    """

    stem: str
    manifest: dict[str, Any]
    growing = ""
    memory: Memory | None = None
    mission: MissionConfig
    scenarios: list[str]
    context: str
    so_far = ""

    def __init__(self, request: Request) -> None:
        self.request = request
        self.directories = tuple(path.resolve() for path in request.directories)

    @property
    def learns_in_turn(self) -> bool:
        """Whether missions run one after the other, and each chooses its options by the results of the earlier ones."""
        return self.memory is not None and self.memory.learns

    def identify(self, identity: Mapping[str, Any], **further: object) -> None:
        """Make the manifest of an identity, with further entries `beside` it."""
        learns = {"learns": True} if self.learns_in_turn else {}
        self.manifest = {
            "identity": {**identity, "files": fingerprints(self.directories), **learns},
            **further,
            "versions": versions(),
            **({LEARNED_BEFORE: as_plain(self.memory.knowledge.learned)} if self.memory is not None else {}),
        }

    def remarks(self) -> list[str]:
        """Return what a user should know of the strategies before they run."""
        return []

    @abstractmethod
    def tasks(self, done: Done) -> Sequence[TrialTask]:
        """Return the tasks for all runs except those that are `done`.

        A search whose runs depend on the results of others returns those that can be done now, and is asked again.
        """

    @abstractmethod
    def mistake(self, record: RunRecord) -> str:
        """Return why a run kept in the directory is not one of this evaluation; empty if it is."""

    def expected(self, done: Done) -> int:
        """Return an estimate of the number of all runs; 0 if those that are known are all."""
        return 0

    def leading(self, costs: Mapping[str, Sequence[float]]) -> str:
        """Return who leads, in words; `costs`: condition -> costs of its runs up to now [s]."""
        best = min(costs, key=lambda name: fmean(costs[name]))
        return f"lowest mean cost {fmean(costs[best]):,.0f} s: {best}"

    def conclude(self) -> None:  # noqa: B027  (most have nothing to add)
        """Write what published results are used with; nothing unless a subclass does."""

    @abstractmethod
    def publication(self, records: Sequence[RunRecord]) -> Publication:
        """Return the report on the finished runs; all runs of this evaluation are among them."""
