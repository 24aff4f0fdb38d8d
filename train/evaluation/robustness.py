"""The evaluation of strategies under disturbances; all strategies and disturbances get the same scenarios."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from clean_swarm_env.config.families import FamilyConfig, RobustnessConfig
from train.analysis.robustness_report import RobustnessReport, RobustnessRuns, robustness_summary_json
from train.evaluation.family import FamilyEvaluation
from train.reports.robustness_tables import robustness_tables
from train.reports.write_report import Publication
from train.request import Request
from train.running.runs import RunRecord


class RobustnessEvaluation(FamilyEvaluation):
    """Strategies on the scenarios of a family, without and under each of several disturbances."""

    def __init__(self, request: Request, robustness: RobustnessConfig) -> None:
        super().__init__(request, robustness)
        self._robustness = robustness

    def variants(self) -> Mapping[str, FamilyConfig]:
        """Return the family without and under each disturbance."""
        return self._robustness.disturbed

    def publication(self, records: Sequence[RunRecord]) -> Publication:
        """Return completion, duration and collisions of each strategy under each disturbance, and the picture."""
        from train.reports.figures import draw_robustness  # waits: the runs need no Matplotlib

        conditions = {entrant.label: entrant.conditions for entrant in self.entrants}
        runs = RobustnessRuns(self._robustness, self.request.seed, tuple(self.scenarios), conditions)
        report = RobustnessReport.of(runs, {record.key: record.result for record in records})
        heading = f"# {self.family.name}\n\n{self.family.description}\n\n"
        grids, summary = robustness_tables(report), robustness_summary_json(report)
        return Publication(heading, grids, summary, draw_robustness(report))
