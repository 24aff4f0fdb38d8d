"""Makes results of docs/results.md again and records them: `python -m docs.figures.update_results`.

The table of `clean-swarm evaluate`, what 100 random start configurations give, and the reference experiment. Takes some
minutes.
"""

import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from docs.figures.stored import ROOT, record

REFERENCE = ROOT / "tests" / "golden" / "data" / "reference.json"
SEED, SCENARIOS = 1, 100
CLEAN_SWARM = (sys.executable, "-c", "from train.cli import main; main()")
"""The command `clean-swarm` of this checkout."""
FIGURES = {
    "duration_s": "duration [s]",
    "samples_per_s_at_0.5m": "samples/s at 0.5 m",
    "events_per_s_at_0.5m": "events/s at 0.5 m",
}


def evaluate(*words: str) -> tuple[str, dict[str, Any]]:
    """Run `clean-swarm evaluate` and return what it prints and its summary."""
    with tempfile.TemporaryDirectory() as directory:
        output = Path(directory) / "run"
        command = [*CLEAN_SWARM, "evaluate", *words]
        done = subprocess.run([*command, "--output", str(output)], cwd=ROOT, check=True, capture_output=True, text=True)
        summary = json.loads((output / "summary.json").read_text(encoding="utf-8"))
    printed = re.sub(r"results in .*", "", done.stdout)
    return "\n".join(line.rstrip() for line in printed.strip().splitlines()), summary


def of_many(summary: dict[str, Any]) -> str:
    """Return completion and ratios of an evaluation of many scenarios as Markdown."""
    lines = ["| | RepulsionFernandez-view2.0 | RepulsionGradient-view1.5 | ratio |", "|---|---|---|---|"]
    conditions = [summary["conditions"][name] for name in ("RepulsionFernandez-view2.0", "RepulsionGradient-view1.5")]
    lines.append("| completed | " + " | ".join(f"{c['completed']} of {c['n']}" for c in conditions) + " | |")
    for metric, name in (
        ("duration_s", "duration [s]"),
        ("collision_samples_per_s", "collision samples per s"),
        ("collision_events_per_s", "collision events per s"),
    ):
        (ratio,) = (c for c in summary["comparisons"] if c["metric"] == metric)
        means = " | ".join(f"{c[metric]['mean']:.3g}" for c in conditions)
        lines.append(f"| {name} | {means} | {interval(ratio)} |")
    return "\n".join(lines)


def of_reference(summary: dict[str, Any]) -> str:
    """Return ours / measured as Markdown, for the figures in FIGURES: conditions first, then ratios to Gradient."""
    lines = [f"| ours / measured | {' | '.join(FIGURES.values())} |", "|---" * (len(FIGURES) + 1) + "|"]
    rows: dict[str, dict[str, str]] = {row["condition"]: {} for row in summary["reference"]}
    for row in summary["reference"]:
        compared = f"{row['ours']:.3g} / {row['measured']:.3g} = {interval(row)}"
        rows[row["condition"]][row["metric"]] = compared
    for row in summary["reference_ratios"]:
        if row["b"] == "RepulsionGradient-view1.5":
            ratios = rows.setdefault(f"{row['a'].removeprefix('Repulsion')} / Gradient", {})
            ratios[row["metric"]] = f"{interval(row['ours'])} / {interval(row['measured'])}"
    for name, cells in rows.items():
        lines.append(f"| {name} | {' | '.join(cells[metric] for metric in FIGURES)} |")
    return "\n".join(lines)


def interval(ratio: dict[str, Any]) -> str:
    """Return a ratio with its interval."""
    low, high = ratio["ci95"]
    return f"{ratio['ratio']:.2f} [{low:.2f}, {high:.2f}]"


def main() -> None:
    """Record all results."""
    record("results/table1", f"```text\n{evaluate()[0]}\n```")
    record("results/many", of_many(evaluate("--scenarios", str(SCENARIOS), "--seed", str(SEED))[1]))
    record("results/reference", of_reference(evaluate("table1-reference", "--starts", str(REFERENCE))[1]))


if __name__ == "__main__":
    main()
