"""The tables of an evaluation on a family: means of each strategy, and how they compare with fixed options."""

from train.analysis.family_report import FamilyReport
from train.analysis.strategy_comparison import ORACLE, Estimate, StrategyComparison, StrategyStanding
from train.reports.text_table import Grid, flat


def family_tables(report: FamilyReport) -> list[Grid]:
    """Return the tables in the order of the report."""
    return [_means(report), *([_gaps(report.comparison)] if report.comparison is not None else [])]


def _means(report: FamilyReport) -> Grid:
    family = report.runs.family
    rows = []
    for label, own in report.summaries.items():
        cost = own["cost_s"]
        row = (
            label,
            f"{own['completed'].mean:.0%}",
            f"{own['items'].mean:.1f}",
            f"{own['duration_s'].mean:.1f}",
            f"{own['events'].mean:.1f}",
            f"{own['events_per_s'].mean:.3f}",
            f"{cost.mean:.1f}",
            "" if cost.ci95 is None else f"[{cost.ci95[0]:.1f}, {cost.ci95[1]:.1f}]",
        )
        rows.append(row)
    every = "for each item done, " if family.scenario(0, 0, "test").mission.continuous else ""
    title = f"{family.name}: means; cost = {every}seconds + {family.mission.collision_cost:g} s an event"
    heads = ("completed", "items", "duration s", "events", "events/s", "cost s", "95 %")
    return flat(title, "strategy", heads, rows)


def _gaps(comparison: StrategyComparison) -> Grid:
    rows = [_gap_row(standing) for standing in comparison.standings]
    title = f"cost beside {comparison.best_fixed} and the {ORACLE}, the best fixed option of each scenario"
    return flat(title, "strategy", ("cost s", "ratio to best fixed", "95 %", "share of the gap", "95 %"), rows)


def _gap_row(standing: StrategyStanding) -> tuple[str, ...]:
    share = standing.share
    return (
        standing.label,
        f"{standing.cost.value:.1f}",
        f"{standing.ratio.value:.3f}",
        _interval(standing.ratio),
        "-" if share is None else f"{share.value:.2f}",
        "" if share is None else _interval(share),
    )


def _interval(estimate: Estimate) -> str:
    return "" if estimate.ci95 is None else f"[{estimate.ci95[0]:.3f}, {estimate.ci95[1]:.3f}]"
