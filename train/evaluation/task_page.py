"""The output of `clean-swarm run`: the table of one task for a terminal, and the page of all tasks in Markdown."""

from collections.abc import Sequence
from dataclasses import replace

from train.evaluation.task_run import TaskOutcome, TaskRun, setting_of
from train.reports.task_tables import MEASURE_HEADS, measure_cells
from train.reports.text_table import Grid, flat


def outcome_grid(outcome: TaskOutcome) -> Grid:
    """Return the results of one task that was run."""
    request, task = outcome.request, outcome.task
    title = f"{request.name} by {outcome.option}: {setting_of(request.mission)}, {_runs(request)}"
    rows = [measure_cells(one) for one in outcome.measured]
    notes = [f"baseline: {task.baseline}"]
    notes += [f"target of {one.measure.name}: {one.measure.reason}" for one in outcome.measured]
    if not outcome.own_setting:
        notes.append(f"targets are stated for {setting_of(request.own_mission)}")
    return replace(flat(title, MEASURE_HEADS[0], MEASURE_HEADS[1:], rows), notes=tuple(notes))


PAGE = """# Tasks

Every task but cleaning (`clean_swarm_env/tasks`), its goal served by the option of the highest score, over {runs}.
Mechanism and baseline have the same starts. Intervals are Student's 95 % intervals; those of the difference are paired
by run. A target, stated in the task's file with its reason, is met when the mean reaches it; a baseline is beaten when
the interval of the difference lies on the better side of zero. A measure without an entry there is a price that must
not be paid for the others. {reached} of {count} tasks meet all their targets and beat their baselines.

Every task also runs on the other ground (`--arena torus|open`), where the targets are for orientation only. On open
land there is nothing to patrol or to fill evenly, and foragers that miss the food never come back: ExplorationPatrol,
UniformDistribution and Foraging miss targets there.

Written by `clean-swarm run --all --output docs/goal_results.md`; `clean-swarm run TASK --option NAME` runs another
option of `configs/knowledge/library.yaml`. A task is a mission: `clean-swarm evaluate --family Foraging` compares all
its options, and any [strategy](strategies.md). How to write one: [own_task.md](own_task.md).

{table}

![Every task: tracks of the robots and where they end](pictures/goals.png)

Drawn by `python -m docs.figures.draw_goals`: tracks of one run, fading into the past, and the robots where they end;
green attracts, red repels.
"""


def as_page(outcomes: Sequence[TaskOutcome]) -> str:
    """Return the page of all tasks for the docs."""
    return PAGE.format(
        runs=_runs(outcomes[0].request),
        reached=sum(outcome.reached for outcome in outcomes),
        count=len(outcomes),
        table=as_markdown(outcomes),
    )


def as_markdown(outcomes: Sequence[TaskOutcome]) -> str:
    """Return a table of the measures of all tasks, and a table of the tasks, as Markdown."""
    lines = [f"| task, option | {' | '.join(MEASURE_HEADS)} |", "|---" * (len(MEASURE_HEADS) + 1) + "|"]
    for outcome in outcomes:
        for index, one in enumerate(outcome.measured):
            first = f"{outcome.request.name}, {outcome.option}" if index == 0 else ""
            lines.append(f"| {first} | {' | '.join(measure_cells(one))} |")
    lines += ["", "| task | story | baseline | where the targets come from |", "|---|---|---|---|"]
    for outcome in outcomes:
        task, ground = outcome.task, outcome.request.mission.world.ground
        reasons = "; ".join(f"{one.measure.name}: {one.measure.reason}" for one in outcome.measured)
        lines.append(f"| {outcome.request.name} | {task.story} ({ground}) | {task.baseline} | {reasons} |")
    return "\n".join(lines)


def _runs(request: TaskRun) -> str:
    return f"{request.runs} run{'s' if request.runs > 1 else ''} of seed {request.seed}"
