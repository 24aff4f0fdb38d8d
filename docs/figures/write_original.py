"""Writes docs/original.md, the original's options beside ours: `python -m docs.figures.write_original [FILE]`.

Every goal runs on its scene by the option of `configs/knowledge/original.yaml` and by the library's, with the same
seeds. Takes some minutes.
"""

import sys
from pathlib import Path

from train.goals.scene_runs import GoalOutcome, GoalRequest, MeasureComparison, run_goal

from clean_swarm_env.scenes import goals
from train.analysis.statistics import Summary

FILE = Path(__file__).parents[1] / "original.md"
KNOWLEDGE, RUNS = "original", 20
PAGE = """# The original's options beside ours

`configs/knowledge/original.yaml` holds what serves each goal in the original implementation: the choices and numbers
of its published expert knowledge (package so_coordinator), made of our components. The file names the source and says
where it differs. Each goal ran {runs} times on its scene (`clean_swarm_env/scenes`, seeds 0 to {last}) by that option
and, on the same starts, by the option of the highest score of our library. Means with Student's 95 % intervals; *met*:
the mean reaches the target of the scene.

- The scenes are ours, and made for our library: they say how the options compare there, not how good the original was.
- Both run on our mechanisms and networks, which deviate from the original by number ([quirks.md](quirks.md)).

{table}

{summary}

Where the original's options miss targets:

- *CircleFormation*: robots gather around the one that they elect, in any place up to 2.5 m from it. The scene has a
  beacon, and asks for a ring.
- *CollectiveExploration*: a flock draws a robot only where it sees neighbours, and the scene has nothing else to
  follow. Most robots stay where they start.
- *FollowMaxPotential*: the movement away from robots is added, and some stay out of the crowd at the source. Without it
  all arrive (1.0).
- *Foraging*, *IndividualExploration*: Exploration draws a new direction with every command, and with a command each
  0.2 s a robot gets nowhere. How often the original commands is not known. With directions kept for 10 s (`leg: 10.0`
  in a copy of the file) the same options bring 4.24 [3.53, 4.95] items a minute, and 92.5 [91.1, 93.9] m2. What else
  separates the foragers is mostly the evaporation, too coarse to tell the ends of a trail apart
  ([0044](decisions/0044-trail-age.md)).
- *FormationControl*: flocking by unnormalised terms (Q30) keeps robots together without a common direction.

Written by `python -m docs.figures.write_original`. One goal: `clean-swarm run ReachGoal --knowledge original`, and
`--option NAME` for another option of the file.
"""


def rows(goal: str, ours: GoalOutcome, theirs: GoalOutcome) -> list[str]:
    """Return the lines of the table for a goal, one for each measure."""
    lines = []
    for index, (mine, other) in enumerate(zip(ours.comparisons, theirs.comparisons, strict=True)):
        first = (goal, theirs.option, ours.option) if index == 0 else ("", "", "")
        unit = "" if mine.measure.unit == "-" else f" [{mine.measure.unit}]"
        sign = "≤" if mine.measure.better == "lower" else "≥"
        cells = (*first, mine.measure.name + unit, f"{sign} {mine.measure.target:g}", reached(other), reached(mine))
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def reached(comparison: MeasureComparison) -> str:
    """Return the mean with its interval, and whether the target is met."""
    return f"{interval(comparison.mechanism)}, {'met' if comparison.met else 'not met'}"


def interval(summary: Summary) -> str:
    """Return a mean with its interval."""
    low, high = summary.ci95 or (summary.mean, summary.mean)
    return f"{summary.mean:.3g} [{low:.3g}, {high:.3g}]"


def page(runs: int) -> str:
    """Run everything and return the page."""
    head = ("goal", "original's option", "library's option", "measure", "target", "original", "library")
    table = [f"| {' | '.join(head)} |", "|---" * len(head) + "|"]
    met = {"original": 0, "library": 0}
    for goal in goals():
        print(goal, flush=True)
        ours, theirs = (
            run_goal(GoalRequest(goal, runs=runs)),
            run_goal(GoalRequest(goal, runs=runs, knowledge=KNOWLEDGE)),
        )
        table += rows(goal, ours, theirs)
        for name, outcome in (("original", theirs), ("library", ours)):
            met[name] += all(c.met for c in outcome.comparisons)
    summary = (
        f"Of the {len(goals())} goals the original's options meet all targets of {met['original']}, "
        f"the library's of {met['library']}."
    )
    return PAGE.format(runs=runs, last=runs - 1, table="\n".join(table), summary=summary)


def main() -> None:
    """Write the page."""
    file = Path(sys.argv[1]) if len(sys.argv) > 1 else FILE
    file.write_text(page(RUNS), encoding="utf-8")
    print(file)


if __name__ == "__main__":
    main()
