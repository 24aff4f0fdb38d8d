"""Strategies on a family with decision periods of different lengths, for which robots hold their options."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from clean_swarm_env.config.families import FamilyConfig
from train.evaluation.choosing.excesses import ExcessComparison
from train.evaluation.family import FamilyEvaluation
from train.evaluation.trial_task import with_periods
from train.reports.write_report import Publication
from train.request import Request
from train.running.runs import RunRecord, under


class PeriodsEvaluation(FamilyEvaluation):
    """Strategies on a family with decision periods of several lengths.

    Args:
        request: the request.
        periods: lengths of a decision period [s], the first of which the others are compared with.
        family: the family, unless it is the one that the request names.

    """

    beside_baselines = False

    def __init__(self, request: Request, periods: Sequence[float], family: FamilyConfig | None = None) -> None:
        self._periods = periods
        super().__init__(request, family)
        self.stem += "-periods"
        self.variants()  # a length that cannot be is an error

    def settings(self) -> Mapping[str, Any]:
        """Return the lengths."""
        return {"periods": list(self._periods)}

    def variants(self) -> Mapping[str, FamilyConfig]:
        """Return the family with each length of a decision period."""
        return with_periods(self.family, self._periods)

    def publication(self, records: Sequence[RunRecord]) -> Publication:
        """Return the excess costs of each strategy with each length, beside those with the first."""
        done, names, against = {record.key: record.result for record in records}, list(self.variants()), {}
        results = {}
        for entrant in self.entrants:
            for name in names:
                own = [under(name, condition) for condition in entrant.conditions]
                results[f"{entrant.label}, {name}"] = [[done[key, each] for key in self.scenarios] for each in own]
                against[f"{entrant.label}, {name}"] = f"{entrant.label}, {names[0]}"
        compared = ExcessComparison(self.family, results, against)
        return compared.publication("decision periods", f"ratio to {names[0]}")
