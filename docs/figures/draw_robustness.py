"""Draws `docs/pictures/robustness.png` and records a table of docs/results.md from the results of an evaluation.

`clean-swarm evaluate robustness --scenarios 25 --output FOLDER`, then `python -m docs.figures.draw_robustness FOLDER`.
"""

import json
import sys
from pathlib import Path
from typing import Any

from clean_swarm_env.config.families import FamilyConfig
from clean_swarm_env.config.load import load_experiment
from docs.figures.stored import record
from train.analysis.intervals import Estimate
from train.analysis.robustness_report import RobustnessReport
from train.reports.charts import picture_of
from train.reports.figures import draw_robustness

DOCS = Path(__file__).parents[1]
PICTURE = DOCS / "pictures" / "robustness.png"
SHOWN = ("none", "messages lost 0.5", "delay 1 s", "robots failing 2 of 5", "noise of poses 0.05 m")
"""Rows of the table; the picture has all."""


def report_of(summary: dict[str, Any]) -> RobustnessReport:
    """Return the report that a `summary.json` holds."""
    estimates = {
        name: {
            label: {figure: Estimate(one["value"], tuple(one["ci95"])) for figure, one in figures.items()}
            for label, figures in by_label.items()
        }
        for name, by_label in summary["disturbances"].items()
    }
    family = load_experiment(summary["experiment"])
    assert isinstance(family, FamilyConfig)
    return RobustnessReport(family, summary["seed"], summary["scenarios"], estimates)


def table(report: RobustnessReport) -> str:
    """Return rows of `SHOWN` as Markdown: duration with its interval, share completed if not all, collisions."""
    labels = list(next(iter(report.estimates.values())))
    lines = [f"| | {' | '.join(labels)} |", "|---" * (len(labels) + 1) + "|"]
    for name in SHOWN:
        by_label, cells = report.estimates[name], []
        for label in labels:
            duration, completed = by_label[label]["duration_s"], by_label[label]["completed"]
            low, high = duration.ci95 or (duration.value, duration.value)
            share = "" if completed.value == 1.0 else f", {completed.value:.0%} done"
            events = f"{by_label[label]['collision_events'].value:.0f} ev."
            cells.append(f"{duration.value:.0f} [{low:.0f}, {high:.0f}]{share}, {events}")
        lines.append(f"| {name} | {' | '.join(cells)} |")
    return "\n".join(lines)


def main(folder: Path) -> None:
    """Draw the picture and record the table."""
    report = report_of(json.loads((folder / "summary.json").read_text(encoding="utf-8")))
    PICTURE.write_bytes(picture_of(draw_robustness(report), PICTURE.suffix))
    record("results/robustness", table(report))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
