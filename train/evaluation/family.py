"""An evaluation of strategies on a family of scenarios, the same for all: run what is missing, compare, report."""

from __future__ import annotations

import json
import shlex
import time
from collections.abc import Sequence
from concurrent.futures.process import BrokenProcessPool
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from clean_swarm_env.config.families import FamilyConfig
from clean_swarm_env.config.files import load_family
from selector.documents.errors import DocumentError
from selector.knowledge import load_knowledge
from train.analysis.statistics import Summary, summarise
from train.analysis.strategy_comparison import ORACLE, Comparison, Estimate, Standing, compare
from train.evaluation.entrants import Entrant, entrants_of, identified, member_pilot
from train.evaluation.experiment import FAILED, FINISHED, INTERRUPTED, progress
from train.evaluation.plan import FINGERPRINTED, fingerprints, versions
from train.reports.text_table import Grid, flat, markdown, on_terminal
from train.running.processes import each_done
from train.running.results import Results, default_directory
from train.running.runs import RunRecord
from train.running.trials import run_trials

CHUNK = 25
"""Scenarios of one task: they run side by side, and are kept together."""
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class FamilyRequest:
    """What the user asked for."""

    family: str
    strategies: tuple[str, ...]
    seed: int
    scenarios: int | None
    knowledge: str | None = None
    """Expert knowledge in place of the family's own."""
    directories: tuple[Path, ...] = ()

    def command(self, output: Path) -> str:
        """Return the command that goes on with this evaluation."""
        words = ["clean-swarm", "evaluate", "--family", self.family, "--seed", str(self.seed)]
        words += [word for text in self.strategies for word in ("--strategy", text)]
        words += ["--scenarios", str(self.scenarios)] if self.scenarios is not None else []
        words += ["--knowledge", self.knowledge] if self.knowledge is not None else []
        words += [word for path in self.directories for word in ("--configs", str(path))]
        return shlex.join([*words, "--output", str(output), "--resume"])


@dataclass(frozen=True)
class TrialTask:
    """Some scenarios of a family under one member of an entrant; plain data that travels to a worker process."""

    family: FamilyConfig
    seed: int
    numbers: tuple[int, ...]
    condition: str
    member: str
    directories: tuple[Path, ...]


def condition_of(entrant: Entrant, member: int) -> str:
    """Return under which name the runs of a member are kept."""
    return entrant.label if len(entrant.members) == 1 else f"{entrant.label}#{member + 1}"


def evaluate_family(
    request: FamilyRequest, *, workers: int, output: Path | None, resume: bool, console: Console
) -> int:
    """Run an evaluation, write its results and print its tables; return the exit code."""
    family = _family(request)
    goal, options = _options(family, request.directories)
    entrants = entrants_of(request.strategies, options)
    count = request.scenarios or family.scenarios
    manifest = _manifest(request, family, entrants)
    stem = f"{family.name}-seed{request.seed}"
    results = Results(output or default_directory(stem, resume=resume), manifest, resume=resume, growing="strategies")
    tasks = _missing(request, family, entrants, count, results)
    total = count * sum(len(entrant.members) for entrant in entrants)
    try:
        with progress(total, total - sum(len(task.numbers) for task in tasks)) as advance:
            for records in each_done(run_task, tasks, workers):
                for record in records:
                    results.add(record)
                    next(advance)
    except (KeyboardInterrupt, BrokenProcessPool) as end:
        results.close()
        errors = Console(stderr=True, highlight=False, soft_wrap=True)
        errors.print(f"{len(results.records)} of {total} runs are kept; to go on:", markup=False)
        errors.print(f"  {request.command(results.directory)}", markup=False)
        return FAILED if isinstance(end, BrokenProcessPool) else INTERRUPTED
    results.close()
    _report(family, request, entrants, count, goal, results, console)
    return FINISHED


def run_task(task: TrialTask) -> list[RunRecord]:
    """Run the scenarios of a task side by side."""
    began = time.perf_counter()
    scenarios = [task.family.scenario(task.seed, number, "test") for number in task.numbers]
    results = run_trials(
        scenarios, lambda problem, teams: member_pilot(task.member, problem, teams), worlds=CHUNK,
        directories=task.directories,
    )  # fmt: skip
    wall = (time.perf_counter() - began) / len(scenarios)
    return [
        RunRecord.of(result, task.family.name, scenario.id, task.seed, task.condition, wall)
        for scenario, result in zip(scenarios, results, strict=True)
    ]


def _family(request: FamilyRequest) -> FamilyConfig:
    family = load_family(request.family, request.directories)
    if request.knowledge is None:
        return family
    return family.model_copy(update={"mission": family.mission.model_copy(update={"knowledge": request.knowledge})})


def _options(family: FamilyConfig, directories: tuple[Path, ...]) -> tuple[str, tuple[str, ...]]:
    """Return the first goal of the expert knowledge and the names of its options."""
    knowledge = load_knowledge(family.mission.knowledge, directories)
    goal = next(iter(knowledge.goals))
    return goal, tuple(option.name for option in knowledge.options(goal))


def _manifest(request: FamilyRequest, family: FamilyConfig, entrants: Sequence[Entrant]) -> dict[str, Any]:
    return {
        "identity": {
            "family": family.model_dump(mode="json"),
            "seed": request.seed,
            "strategies": {entrant.label: [identified(member) for member in entrant.members] for entrant in entrants},
            "files": fingerprints(FINGERPRINTED, request.directories),
        },
        "versions": versions(),
    }


def _missing(
    request: FamilyRequest, family: FamilyConfig, entrants: Sequence[Entrant], count: int, results: Results
) -> list[TrialTask]:
    """Return the tasks of which a run is missing, with the scenarios that are."""
    done = {record.key for record in results.records}
    tasks = []
    for entrant in entrants:
        for k, member in enumerate(entrant.members):
            condition = condition_of(entrant, k)
            numbers = [n for n in range(count) if (f"test-{n + 1}", condition) not in done]
            for first in range(0, len(numbers), CHUNK):
                some = tuple(numbers[first : first + CHUNK])
                tasks.append(TrialTask(family, request.seed, some, condition, member, request.directories))
    return tasks


def _report(
    family: FamilyConfig, request: FamilyRequest, entrants: Sequence[Entrant], count: int, goal: str,
    results: Results, console: Console,
) -> None:  # fmt: skip
    figures = _figures(1.0 / family.mission.world.control_rate, entrants, count, results.records)
    fixed = tuple(entrant.label for entrant in entrants if entrant.fixed)
    grids = [_means(family, entrants, figures)]
    summary: dict[str, Any] = {
        "family": family.name, "goal": goal, "scenarios": count, "seed": request.seed,
        "strategies": {
            entrant.label: {name: asdict(_over_all(values)) for name, values in figures[entrant.label].items()}
            for entrant in entrants
        },
    }  # fmt: skip
    if fixed:
        comparison = compare({label: values["cost_s"] for label, values in figures.items()}, fixed)
        grids.append(_gaps(comparison))
        summary["best_fixed"] = comparison.best_fixed
        summary["comparison"] = [asdict(standing) for standing in comparison.standings]
    results.write("summary.json", json.dumps(summary, indent=2) + "\n")
    results.write("table.md", f"# {family.name}\n\n{family.description}\n\n" + "\n".join(map(markdown, grids)))
    for grid in grids:
        console.print(on_terminal(grid), soft_wrap=True)
        console.print()
    console.print(f"results in {results.directory}", soft_wrap=True, highlight=False)


def _figures(
    period: float, entrants: Sequence[Entrant], count: int, records: Sequence[RunRecord]
) -> dict[str, dict[str, Floats]]:
    """Return label -> figure -> (S, K) for S members on K scenarios; `period` [s] of one tick."""
    at = {record.key: record for record in records}
    figures = {}
    for entrant in entrants:
        names = [condition_of(entrant, k) for k in range(len(entrant.members))]
        table = [[at[f"test-{n + 1}", name] for n in range(count)] for name in names]
        figures[entrant.label] = {
            "cost_s": np.array([[r.cost_s for r in row] for row in table]),
            "duration_s": np.array([[r.duration_s for r in row] for row in table]),
            "events": np.array([[r.collision_events_per_s[0] * r.ticks * period for r in row] for row in table]),
            "events_per_s": np.array([[r.collision_events_per_s[0] for r in row] for row in table]),
            "items": np.array([[float(r.garbage_done) for r in row] for row in table]),
            "completed": np.array([[float(r.completed) for r in row] for row in table]),
        }
    return figures


def _over_all(values: Floats) -> Summary:
    """Return location and spread over scenarios of the means (K,) over members of `values` (S, K)."""
    return summarise(values.mean(axis=0))


def _means(family: FamilyConfig, entrants: Sequence[Entrant], figures: dict[str, dict[str, Floats]]) -> Grid:
    heads = ("completed", "items", "duration s", "events", "events/s", "cost s", "95 %")
    rows = []
    for entrant in entrants:
        own = {name: _over_all(values) for name, values in figures[entrant.label].items()}
        cost = own["cost_s"]
        rows.append(
            (
                entrant.label, f"{own['completed'].mean:.0%}", f"{own['items'].mean:.1f}",
                f"{own['duration_s'].mean:.1f}", f"{own['events'].mean:.1f}", f"{own['events_per_s'].mean:.3f}",
                f"{cost.mean:.1f}", "" if cost.ci95 is None else f"[{cost.ci95[0]:.1f}, {cost.ci95[1]:.1f}]",
            )
        )  # fmt: skip
    price = family.mission.collision_cost
    every = "for each item done, " if family.scenario(0, 0, "test").mission.continuous else ""
    title = f"{family.name}: means; cost = {every}seconds + {price:g} s an event"
    return flat(title, "strategy", heads, rows)


def _gaps(comparison: Comparison) -> Grid:
    rows = [_gap_row(standing) for standing in comparison.standings]
    title = f"cost beside {comparison.best_fixed} and the {ORACLE}, the best fixed option of each scenario"
    return flat(title, "strategy", ("cost s", "ratio to best fixed", "95 %", "share of the gap", "95 %"), rows)


def _gap_row(standing: Standing) -> tuple[str, ...]:
    share = standing.share or Estimate(float("nan"), None)
    return (
        standing.label, f"{standing.cost.value:.1f}", f"{standing.ratio.value:.3f}", _shown(standing.ratio),
        "-" if standing.share is None else f"{share.value:.2f}", _shown(share),
    )  # fmt: skip


def _shown(estimate: Estimate) -> str:
    return "" if estimate.ci95 is None else f"[{estimate.ci95[0]:.3f}, {estimate.ci95[1]:.3f}]"


def check_entrants(request: FamilyRequest) -> None:
    """Raise an error of one line for a strategy that does not exist or does not fit, before anything is written."""
    from clean_swarm_env.learning.batch import Batch
    from train.running.trials import problem_of

    family = _family(request)
    batch = Batch(family.scenario(0, 0, "test").mission, directories=request.directories)
    problem = problem_of(batch)
    for entrant in entrants_of(request.strategies, problem.options):
        for member in entrant.members:
            try:
                member_pilot(member, problem, np.zeros(batch.rows, dtype=np.int64))
            except DocumentError as error:
                raise DocumentError(f"--strategy {entrant.label}: {error}") from error
