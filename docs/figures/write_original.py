"""Writes docs/original.md, the original's options beside ours: `python -m docs.figures.write_original [FILE]`.

Every task runs by the option of `configs/knowledge/original.yaml` and by the library's, from the same starts. Takes a
minute.
"""

import sys
from pathlib import Path

from docs.figures.draw_goals import tasks_to_run
from docs.figures.stored import take
from train.analysis.family_report import FamilyReport
from train.analysis.statistics import Summary
from train.analysis.task_report import MeasuredStrategy
from train.evaluation.comparing import Comparing
from train.request import Request
from train.running.engine import in_turn

FILE = Path(__file__).parents[1] / "original.md"
KNOWLEDGE, RUNS = "original", 20
PAGE = """# The original's options beside ours

`configs/knowledge/original.yaml` has the original implementation's options for each goal: the choices and numbers
of its published expert knowledge (package so_coordinator), made of our components. The file names the source and its
differences from it. Each goal was served {runs} times in its task (`clean_swarm_env/tasks`, seed 0) by that option and,
from the same starts, by the option of the highest score of our library. Means with Student's 95 % intervals; *met*: the
mean reaches the target of the task.

- The tasks are ours, and made for our library: they compare the options there, and do not judge the original.
- Both run on our mechanisms and networks, which deviate from the original by number ([quirks.md](quirks.md)).

<!-- begin: goals -->
{table}
<!-- end: goals -->

{summary}

Where the original's options miss targets:

- *CircleFormation*: robots gather around the one that they elect, in any place up to 2.5 m from it. The task has a
  beacon, and asks for a ring.
- *CollectiveExploration*: a flock draws a robot only where it sees neighbours, and the task has nothing else to
  follow. Most robots stay where they start.
- *FollowMaxPotential*: the movement away from robots is added, and some stay out of the crowd at the source. Without it
  all arrive (1.0).
- *Foraging*, *IndividualExploration*: Exploration draws a new direction with every command, and with a command each
  0.2 s a robot gets nowhere. How often the original commands is not known. With directions kept for 10 s (`leg: 10.0`
  in a copy of the file) the same options brought 4.24 [3.53, 4.95] items a minute, and 92.5 [91.1, 93.9] m2, on
  earlier starts. What else separates the foragers is mostly the evaporation, too coarse to tell the ends of a trail
  apart.
- *FormationControl*: flocking by unnormalised terms (Q30) keeps robots together without a common direction.

Written by `python -m docs.figures.write_original`. One goal: `clean-swarm evaluate ReachGoal --knowledge
original`, with each option of the file.
"""
BY_SCORE = "MaxScore"
Outcome = tuple[str, list[MeasuredStrategy]]
"""An option, and the measures of the task that it serves."""


def measured(task: str, knowledge: str | None, runs: int) -> Outcome:
    """Return the option of the highest score for a task by some knowledge, and its measures."""
    evaluation = Comparing(Request(task, (BY_SCORE,), scenarios=runs, knowledge=knowledge))
    records = list(in_turn(evaluation.tasks({})))
    report = FamilyReport.of(evaluation.runs(records, {BY_SCORE: (BY_SCORE,)}))
    best = int(evaluation.batch.choices.default[0])
    return evaluation.problem.options[best], [one for one in report.measured if one.strategy == BY_SCORE]


def rows(goal: str, ours: Outcome, theirs: Outcome) -> list[str]:
    """Return the lines of the table for a goal, one for each measure."""
    lines = []
    for index, (mine, other) in enumerate(zip(ours[1], theirs[1], strict=True)):
        first = (goal, theirs[0], ours[0]) if index == 0 else ("", "", "")
        unit = "" if mine.measure.unit == "-" else f" [{mine.measure.unit}]"
        sign = "≤" if mine.measure.better == "lower" else "≥"
        cells = (*first, mine.measure.name + unit, f"{sign} {mine.measure.target:g}", reached(other), reached(mine))
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def reached(one: MeasuredStrategy) -> str:
    """Return the mean with its interval, and whether the target is met."""
    return f"{interval(one.own)}, {'met' if one.met else 'not met'}"


def interval(summary: Summary) -> str:
    """Return a mean with its interval."""
    low, high = summary.ci95 or (summary.mean, summary.mean)
    return f"{summary.mean:.3g} [{low:.3g}, {high:.3g}]"


def page(runs: int) -> str:
    """Run everything and return the page."""
    head = ("goal", "original's option", "library's option", "measure", "target", "original", "library")
    table = [f"| {' | '.join(head)} |", "|---" * len(head) + "|"]
    met = {"original": 0, "library": 0}
    tasks = tasks_to_run()
    for name in tasks:
        print(name, flush=True)
        ours, theirs = measured(name, None, runs), measured(name, KNOWLEDGE, runs)
        table += rows(name, ours, theirs)
        for source, outcome in (("original", theirs), ("library", ours)):
            met[source] += all(one.met for one in outcome[1])
    summary = (
        f"Of the {len(tasks)} goals the original's options meet all targets of {met['original']}, "
        f"the library's of {met['library']}."
    )
    return PAGE.format(runs=runs, table="\n".join(table), summary=summary)


def main() -> None:
    """Write the page."""
    file = Path(sys.argv[1]) if len(sys.argv) > 1 else FILE
    file.write_text(page(RUNS), encoding="utf-8")
    if file == FILE:
        take("original/goals")
    print(file)


if __name__ == "__main__":
    main()
