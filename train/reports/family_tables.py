"""The tables of an evaluation on a family: means, comparison with fixed options, and costs over prices."""

from clean_swarm_env.world.mission_end import LEFT_LIMITS
from train.analysis.family_report import FamilyReport
from train.analysis.front import PRICES
from train.analysis.strategy_comparison import ORACLE, Estimate, StrategyComparison, StrategyStanding
from train.reports.text_table import EMPTY_CELL, Grid, flat


def family_tables(report: FamilyReport) -> list[Grid]:
    """Return the tables in the order of the report."""
    return [_means(report), *([_gaps(report.comparison)] if report.comparison is not None else []), _prices(report)]


def _means(report: FamilyReport) -> Grid:
    family = report.runs.family
    rows = []
    for label, own in report.summaries.items():
        excess = own["excess_s"]
        row = (
            label,
            f"{own['completed'].mean:.0%}",
            f"{own['items'].mean:.1f}",
            f"{own['duration_s'].mean:.1f}",
            f"{own['events'].mean:.1f}",
            f"{own['contact_s'].mean:.1f}",
            f"{own['cost_s'].mean:.1f}",
            f"{excess.mean:.1f}",
            "" if excess.ci95 is None else f"[{excess.ci95[0]:.1f}, {excess.ci95[1]:.1f}]",
        )
        rows.append(row)
    mission = family.scenario(0, 0, "test").mission
    every = "for each item done, " if mission.continuous else ""
    contact = f" + {mission.contact_cost:g} s a second in contact" if mission.contact_cost else ""
    left = "" if mission.continuous else f" + {LEFT_LIMITS * mission.time_limit:g} s an item left"
    title = f"{family.name}: means; cost = {every}seconds + {mission.collision_cost:g} s an event{contact}{left}"
    heads = ("completed", "items", "duration s", "events", "contact s", "cost s", "excess s", "95 %")
    return flat(title, "strategy", heads, rows)


def _gaps(comparison: StrategyComparison) -> Grid:
    rows = [_gap_row(standing, comparison) for standing in comparison.standings]
    title = f"excess cost beside {comparison.best_fixed}"
    if comparison.gap is None:
        told = f"no {ORACLE}: it needs --world-seeds 2 or more"
    elif comparison.has_gap:
        title += f" and the {ORACLE}, the best fixed option of each scenario"
        told = (
            f"gap {comparison.gap.value:.1f} s {_interval(comparison.gap, 1)}; the {ORACLE} chose on other world seeds"
        )
    else:
        told = f"no gap: {comparison.gap.value:.1f} s {_interval(comparison.gap, 1)} to the {ORACLE}"
    heads = ("excess s", "ratio to best fixed", "95 %", "p", "share of the gap", "95 %")
    grid = flat(title, "strategy", heads, rows)
    return Grid(grid.title, grid.corner, grid.columns, grid.rows, notes=(told,))


def _gap_row(standing: StrategyStanding, comparison: StrategyComparison) -> tuple[str, ...]:
    share = standing.share
    return (
        standing.label,
        f"{standing.excess.value:.1f}",
        f"{standing.ratio.value:.3f}",
        _interval(standing.ratio),
        EMPTY_CELL if standing.p is None or standing.label == comparison.best_fixed else f"{standing.p:.2g}",
        "no gap" if share is None else f"{share.value:.2f}",
        "" if share is None else _interval(share),
    )


def _prices(report: FamilyReport) -> Grid:
    front = report.front
    best = [front.best_at(price) for price in PRICES]
    rows = [
        (
            label,
            "yes" if label in front.undominated else "",
            *(f"{value:.1f}{' *' if label == best[k] else ''}" for k, value in enumerate(excesses)),
        )
        for label, excesses in front.excesses.items()
    ]
    heads = ("undominated", *(f"{price:g} s" for price in PRICES))
    title = (
        "excess cost in s over prices of a collision event; * lowest; undominated: none has less time and fewer events"
    )
    return flat(title, "strategy", heads, rows)


def _interval(estimate: Estimate, digits: int = 3) -> str:
    return "" if estimate.ci95 is None else f"[{estimate.ci95[0]:.{digits}f}, {estimate.ci95[1]:.{digits}f}]"
