"""The output of `clean-swarm run`: the table of one goal for a terminal, and the page of all goals in Markdown."""

from collections.abc import Sequence

from rich import box
from rich.console import Group
from rich.table import Table
from rich.text import Text

from train.analysis.statistics import Summary
from train.goals.scene_runs import GoalOutcome, MeasureComparison

VERDICTS = {True: "yes", False: "no", None: "-"}
MEASURE_HEADS = ("measure", "mean", "target", "baseline", "difference", "target met", "beats baseline")
"""Heads of the columns of both tables; intervals are 95 % intervals."""


def goal_on_terminal(outcome: GoalOutcome) -> Group:
    """Return the results of one goal for a terminal."""
    lines = [
        Text(f"{outcome.scene.goal} by {outcome.option}: {_setting(outcome)}"),
        Text(f"baseline: {outcome.scene.baseline}"),
        Text(""),
    ]
    table = Table(box=box.HORIZONTALS, show_edge=False)
    for index, name in enumerate(MEASURE_HEADS):
        table.add_column(name, justify="left" if index == 0 else "right")
    for comparison in outcome.comparisons:
        table.add_row(*_cells(comparison))
    notes = [Text(f"target of {c.measure.name}: {c.measure.reason}") for c in outcome.comparisons]
    if not outcome.own_setting:
        own = outcome.scene.setting
        notes.append(Text(f"targets are stated for {own.robots} robots, {own.seconds:g} s, {own.ground}"))
    return Group(*lines, table, Text(""), *notes)


PAGE = """# Goals

Every goal of the configuration library in its scene (`clean_swarm_env/scenes`), served by the option of the highest
score, over {runs} runs with seeds {first} to {last}. Mechanism and baseline have the same starts. Intervals are
Student's 95 % intervals; those of the difference are paired by run. A target, stated in the scene's file with its
reason, is met when the mean reaches it; a baseline is beaten when the interval of the difference lies on the better
side of zero. A measure without an entry there is a price that must not be paid for the others. {reached} of {count}
goals meet all their targets and beat their baselines.

Every goal also runs on the other ground (`--arena torus|open`), where the targets are for orientation only. On open
land there is nothing to patrol or to fill evenly, and foragers that miss the food never come back: ExplorationPatrol,
UniformDistribution and Foraging miss targets there.

Written by `clean-swarm run --all --output docs/goals.md`; `clean-swarm run GOAL --option NAME` runs another option of
`configs/knowledge/library.yaml`.

{table}

![Every goal in its scene: tracks of the robots and where they end](pictures/goals.png)

Drawn by `python -m docs.figures.draw_goals`: tracks of one run, fading into the past, and the robots where they end;
green attracts, red repels.
"""


def as_page(outcomes: Sequence[GoalOutcome]) -> str:
    """Return the page of all goals for the docs."""
    seeds = outcomes[0].seeds
    return PAGE.format(
        runs=len(seeds),
        first=seeds[0],
        last=seeds[-1],
        reached=sum(outcome.reached for outcome in outcomes),
        count=len(outcomes),
        table=as_markdown(outcomes),
    )


def as_markdown(outcomes: Sequence[GoalOutcome]) -> str:
    """Return a table of all goals and a table of their scenes as Markdown."""
    lines = [f"| goal, option | {' | '.join(MEASURE_HEADS)} |", "|---" * (len(MEASURE_HEADS) + 1) + "|"]
    for outcome in outcomes:
        for index, comparison in enumerate(outcome.comparisons):
            first = f"{outcome.scene.goal}, {outcome.option}" if index == 0 else ""
            lines.append(f"| {first} | {' | '.join(_cells(comparison))} |")
    lines += ["", "| goal | scene | baseline | where the targets come from |", "|---|---|---|---|"]
    for outcome in outcomes:
        scene = outcome.scene
        reasons = "; ".join(f"{c.measure.name}: {c.measure.reason}" for c in outcome.comparisons)
        lines.append(f"| {scene.goal} | {scene.story} ({outcome.setting.ground}) | {scene.baseline} | {reasons} |")
    return "\n".join(lines)


def _cells(comparison: MeasureComparison) -> tuple[str, ...]:
    measure = comparison.measure
    unit = "" if measure.unit == "-" else f" [{measure.unit}]"
    sign = "≤" if measure.better == "lower" else "≥"
    return (
        measure.name + unit,
        _interval(comparison.mechanism),
        f"{sign} {measure.target:g}",
        _interval(comparison.baseline),
        _interval(comparison.difference),
        VERDICTS[comparison.met],
        VERDICTS[comparison.beats],
    )


def _interval(summary: Summary) -> str:
    mean = f"{summary.mean:.3g}"
    if summary.ci95 is None:
        return mean
    low, high = summary.ci95
    return f"{mean} [{low:.3g}, {high:.3g}]"


def _setting(outcome: GoalOutcome) -> str:
    setting, seeds = outcome.setting, outcome.seeds
    which = f"seed {seeds[0]}" if len(seeds) == 1 else f"seeds {seeds[0]} to {seeds[-1]}"
    return f"{setting.robots} robots, {setting.seconds:g} s, {setting.ground}, {which}"
