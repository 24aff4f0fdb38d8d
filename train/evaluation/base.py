"""Evaluations: the base class of those of an experiment and of a family."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from functools import cached_property
from types import MappingProxyType
from typing import Annotated, Any

from pydantic import Field

from clean_swarm_env.config.mission import MissionConfig
from selector.documents.fields import Closed, Flag
from selector.strategies.strategy import DecisionStrategy
from train.memory import Memory, as_plain
from train.reports.text_table import Publication
from train.request import Request
from train.running.run_folder import LEARNED_BEFORE, fingerprints, versions
from train.running.runs import Job, RunKey, RunRecord

OWN_STARTS = "own starts"


class Asked(Closed):
    """What the identity of results does not say of the evaluation; the manifest has it beside."""

    scenarios: Annotated[int, Field(strict=True, ge=1, le=10_000)] = 1
    """Scenarios of a family."""
    worlds: Annotated[int, Field(strict=True, ge=1, le=100)] = 1
    """World seeds of each."""
    scoring: Flag = False
    """Whether the strategies or conditions are fixed options, each of which is scored."""
    starts: str = OWN_STARTS
    """Where the start configurations of an experiment come from, in two words or by a path."""
    starts_from: str = ""
    """The same in a sentence."""
    measured: Mapping[str, Mapping[str, Mapping[str, float | None]]] = Field(default={})
    """Figures measured on them elsewhere: scenario -> name of a condition -> figure -> value."""


Choosers = Mapping[str, DecisionStrategy]
"""Goal -> strategy with one row, which chooses one option for the whole team and mission."""
Done = Mapping[RunKey, RunRecord | None]
"""Runs that need not be done: their records, or None for those that others do."""


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
        asked: what the identity does not say.
        context: under which a store keeps rewards of such missions.
        scored: condition -> goal -> option, where runs of fixed options are scored for the store.

    """

    stem: str
    manifest: dict[str, Any]
    growing = ""
    memory: Memory | None = None
    mission: MissionConfig
    scenarios: list[str]
    asked: Asked
    context: str
    scored: Mapping[str, Mapping[str, str]] = MappingProxyType({})

    def __init__(self, request: Request) -> None:
        self.request = request
        self.directories = tuple(path.resolve() for path in request.directories)

    @property
    def learns_in_turn(self) -> bool:
        """Whether missions run one after the other, and each chooses its options by the results of the earlier ones."""
        return self.memory is not None and self.memory.learns and not self.scored

    @cached_property
    def keys(self) -> list[RunKey]:
        """Scenario and condition of all runs that are known before the first, condition by condition."""
        return sorted((key for task in self.tasks({}) for key in task.keys), key=lambda key: key[1])

    def identify(self, identity: Mapping[str, Any], **beside: object) -> None:
        """Make the manifest of an identity, with further entries `beside` it."""
        learns = {"learns": True} if self.learns_in_turn else {}
        self.manifest = {
            "identity": {**identity, "files": fingerprints(self.directories), **learns},
            **beside,
            "versions": versions(),
            **({LEARNED_BEFORE: as_plain(self.memory.knowledge.learned)} if self.memory is not None else {}),
        }

    def remarks(self) -> list[str]:
        """Return what a user should know of the strategies before they run."""
        return []

    @abstractmethod
    def tasks(self, done: Done) -> Sequence[Job]:
        """Return the tasks for all runs except those that are `done`.

        A search whose runs depend on the results of others returns those that can be done now, and is asked again.
        """

    @abstractmethod
    def mistake(self, record: RunRecord) -> str:
        """Return why a run kept in the directory is not one of this evaluation; empty if it is."""

    @abstractmethod
    def choosers(self) -> Mapping[str, Choosers]:
        """Return for each condition the strategies that choose an option of each goal once in a mission."""

    @abstractmethod
    def task_with(self, scenario: str, condition: str, options: Mapping[str, str]) -> Job:
        """Return the task of one run in which `options` serve the goals; goal -> option."""

    @abstractmethod
    def publication(self, records: Sequence[RunRecord]) -> Publication:
        """Return the report on the finished runs; all runs of this evaluation are among them."""
