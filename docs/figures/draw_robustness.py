"""Takes `docs/pictures/robustness.png` and a table of docs/results.md from the results of an evaluation.

`clean-swarm evaluate robustness --scenarios 25 --output FOLDER`, then `python -m docs.figures.draw_robustness FOLDER`.
"""

import json
import shutil
import sys
from pathlib import Path
from typing import Any

from docs.figures.stored import record

DOCS = Path(__file__).parents[1]
PICTURE = DOCS / "pictures" / "robustness.png"
SHOWN = ("none", "messages lost 0.5", "delay 1 s", "robots failing 2 of 5", "noise of poses 0.05 m")
"""Columns of the table; the picture has all."""


def table(disturbances: dict[str, Any]) -> str:
    """Return columns of `SHOWN` as Markdown: duration with its interval, share completed if not all, collisions."""
    lines = [f"| | {' | '.join(SHOWN)} |", "|---" * (len(SHOWN) + 1) + "|"]
    for label in next(iter(disturbances.values())):
        cells = []
        for name in SHOWN:
            figures = disturbances[name][label]
            duration, completed = figures["duration_s"], figures["completed"]["value"]
            low, high = duration["ci95"]
            share = "" if completed == 1.0 else f", {completed:.0%} done"
            events = f"{figures['collision_events']['value']:.0f} ev."
            cells.append(f"{duration['value']:.0f} [{low:.0f}, {high:.0f}]{share}, {events}")
        lines.append(f"| `{label}` | {' | '.join(cells)} |")
    return "\n".join(lines)


def main(folder: Path) -> None:
    """Copy the picture and record the table."""
    shutil.copy(folder / "figure.png", PICTURE)
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    record("results/robustness", table(summary["disturbances"]))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
