"""Evaluations: the base class of those that compare and of those that advise, and what their manifests say."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from statistics import fmean
from typing import Any

from clean_swarm_env.config.mission import MissionConfig
from train.evaluation.comparison import Comparison
from train.memory import Memory, as_plain
from train.reports.text_table import Publication
from train.request import Request
from train.running.run_folder import LEARNED_BEFORE, versions
from train.running.runs import RunKey, RunRecord
from train.running.trial_task import TrialTask

Done = Mapping[RunKey, RunRecord]
"""Runs that need not be done."""


class Evaluation(ABC):
    """Base class of evaluations, which define runs and a report on them.

    The constructor gets the user's request, and raises an error of one line, before anything is written, for everything
    that does not exist or fit.

    Attributes:
        request: the request.
        directories: the user's own directories of configurations.
        comparison: what the runs depend on; it decides whether they can be resumed.
        stem: name of the default directory for the results.
        manifest: content of `manifest.json`: the comparison as `identity`, the rest is for readers.
        memory: the knowledge store of this evaluation, if any.
        mission: the mission; before the runs begin it gets what was learned of its options.
        learned: what was learned at the beginning, as plain data.
        scenarios: names of the scenarios, in the order in which missions learn.
        context: under which a store keeps rewards of such missions.
        led_by: what says who leads in the progress, "cost" or "duration".
        so_far: what is known before all runs are done, which follows how many are kept.

    """

    stem: str
    comparison: Comparison
    manifest: dict[str, Any]
    memory: Memory | None = None
    mission: MissionConfig
    learned: Mapping[str, Any] = {}
    scenarios: list[str]
    context: str
    led_by = "cost"
    so_far = ""

    def __init__(self, request: Request) -> None:
        self.request = request
        self.directories = tuple(path.resolve() for path in request.directories)

    @property
    def learns_in_turn(self) -> bool:
        """Whether missions run one after the other, and each chooses its options by the results of the earlier ones."""
        return self.memory is not None and self.memory.learns

    def identify(self, comparison: Comparison, **settings: object) -> None:
        """Make the manifest of a comparison; its identity has further `settings`."""
        self.comparison = comparison
        learns = {"learns": True} if self.learns_in_turn else {}
        self.manifest = {
            "identity": {**comparison.identity, **settings, **learns},
            "directories": [str(path) for path in self.directories],
            "versions": versions(),
            **({LEARNED_BEFORE: as_plain(self.memory.knowledge.learned)} if self.memory is not None else {}),
        }

    def start_with(self, learned: Mapping[str, Any]) -> None:
        """Let the runs begin with what was learned, if anything."""
        self.learned, self.mission = learned, self.mission.beginning_with(learned)

    def remarks(self) -> list[str]:
        """Return what a user should know of the strategies before they run."""
        return []

    @abstractmethod
    def tasks(self, done: Done) -> Sequence[TrialTask]:
        """Return the tasks for all runs except those that are `done`.

        A search whose runs depend on the results of others returns those that can be done now, and is asked again.
        """

    def mistake(self, record: RunRecord) -> str:
        """Return why a run kept in the directory is not one of this evaluation; empty if it is.

        It may be of further scenarios and of other conditions. DocumentError if there is no such scenario.
        """
        document = self.comparison.document
        return record.mistake(document.name, self.comparison.seed, document.bound(record.scenario))

    def expected(self, done: Done) -> int:
        """Return an estimate of the number of all runs; 0 if those that are known are all."""
        return 0

    def leading(self, costs: Mapping[str, Sequence[float]]) -> str:
        """Return who leads, in words; `costs`: condition -> costs, or durations, of its runs up to now [s]."""
        best = min(costs, key=lambda name: fmean(costs[name]))
        return f"lowest mean {self.led_by} {fmean(costs[best]):,.0f} s: {best}"

    def conclude(self) -> None:  # noqa: B027  (most have nothing to add)
        """Write what published results are used with; nothing unless a subclass does."""

    @abstractmethod
    def publication(self, records: Sequence[RunRecord]) -> Publication:
        """Return the report on the finished runs; all runs of this evaluation are among them."""
