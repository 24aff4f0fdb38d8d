"""The evaluation of strategies under disturbances; all strategies and disturbances get the same scenarios."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

from clean_swarm_env.config.families import RobustnessConfig
from train.analysis.robustness_report import RobustnessReport, RobustnessRuns, robustness_summary_json
from train.evaluation.family import FamilyEvaluation, FamilyRequest
from train.evaluation.trial_task import TrialTask
from train.reports.robustness_figure import draw_robustness
from train.reports.robustness_tables import robustness_tables
from train.reports.write_report import Publication
from train.running.runs import RunKey, RunRecord, under


class RobustnessEvaluation(FamilyEvaluation):
    """Strategies on the scenarios of a family, without and under each of several disturbances."""

    def __init__(self, request: FamilyRequest, robustness: RobustnessConfig) -> None:
        super().__init__(request, robustness)
        self._robustness, self._disturbed = robustness, robustness.disturbed
        self.words = [word for word in replace(request, strategies=()).words if word != "--family"]
        del self.manifest["identity"]["family"]["strategies"]  # they stand beside the family, where they may grow

    def tasks(self, done: Collection[RunKey]) -> list[TrialTask]:
        """Return the tasks for all missing runs, each of one disturbance."""
        tasks = []
        for name, family in self._disturbed.items():
            own = [(s, c) for s in self.scenarios for c, _ in self._members() if (s, under(name, c)) in done]
            mission = family.mission.model_copy(update={"store": "", "learned": self.mission.learned})
            disturbed = family.model_copy(update={"mission": mission})
            tasks += [
                replace(task, family=disturbed, condition=under(name, task.condition)) for task in super().tasks(own)
            ]
        return tasks

    def publication(self, records: Sequence[RunRecord]) -> Publication:
        """Return completion, duration and collisions of each strategy under each disturbance, and the picture."""
        conditions = {entrant.label: entrant.conditions for entrant in self.entrants}
        runs = RobustnessRuns(self._robustness, self._request.seed, tuple(self.scenarios), conditions)
        report = RobustnessReport.of(runs, {record.key: record.result for record in records})
        heading = f"# {self.family.name}\n\n{self.family.description}\n\n"
        grids, summary = robustness_tables(report), robustness_summary_json(report)
        return Publication(heading, grids, summary, draw_robustness(report))
