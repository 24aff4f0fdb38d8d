"""The tables of strategies under disturbances: one for each strategy, a row for each disturbance."""

from train.analysis.robustness_report import RobustnessReport
from train.analysis.strategy_comparison import Estimate
from train.reports.text_table import Grid, flat

MULTIPLES = {
    "completed": ("completed %", 100.0),
    "duration_s": ("duration s", 1.0),
    "collision_events": ("collision events", 1.0),
}
"""Head of the column of each figure, and what its numbers are multiplied by."""
INTERVALS = "95 % intervals by Wilson (completed) and Student; a mission that is not completed lasts its time limit"


def robustness_tables(report: RobustnessReport) -> list[Grid]:
    """Return the tables in the order of the strategies."""
    runs, grids = report.runs, []
    heads = tuple(text for head, _ in MULTIPLES.values() for text in (head, "95 %"))
    for label in runs.conditions:
        rows = []
        for name, by_label in report.estimates.items():
            cells = (
                cell for figure, (_, factor) in MULTIPLES.items() for cell in _cells(by_label[label][figure], factor)
            )
            rows.append((name, *cells))
        title = f"{label}: {len(runs.scenarios)} scenarios, seed {runs.seed}; {INTERVALS}"
        grids.append(flat(title, "disturbance", heads, rows))
    return grids


def _cells(estimate: Estimate, factor: float) -> tuple[str, str]:
    ends = "" if estimate.ci95 is None else "[{:.1f}, {:.1f}]".format(*(factor * end for end in estimate.ci95))
    return f"{factor * estimate.value:.1f}", ends
