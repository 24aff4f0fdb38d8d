"""One step of one robot as a reader sees it: what it weighed, what it planned, what runs and why; and a whole run kept.

The text is meant for 80 columns: a table of what adds up to each behaviour's activation, a tree of reasons, conditions
and goals.
"""

import io
import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text
from rich.tree import Tree

from clean_swarm_env.config_errors import ConfigurationError
from clean_swarm_env.worlds import Worlds
from selforg.network.explanation import BehaviourAccount, ConditionAccount, Explanation, GoalAccount, explain
from selforg.network.explanation_text import COLUMNS, header
from selforg.network.recording import Recorder, stacked
from train.repeat import steps_of, world_at
from train.results import write_atomically
from train.runs import RunTask

HEADS = {"goal_inhibition": "inhib.", "predecessors": "pred.", "successors": "succ.", "conflictors": "confl."}
"""Short forms of columns, which let the table fit."""


def explained(task: RunTask, robot: int, time: float) -> tuple[dict[str, Any], Explanation]:
    """Repeat a run up to `time` [s]; return where the robot was in the run, and the explanation of its step."""
    count = task.mission.robots.count
    if not 0 <= robot < count:
        raise ConfigurationError(f"--robot: expected a number from 0 to {count - 1}, got {robot}")
    worlds = world_at(task, time)
    record = Recorder(worlds.network, np.array([robot])).take()
    return _situation(task, worlds, robot), explain(worlds.network.model, record, robot)


def _situation(task: RunTask, worlds: Worlds, robot: int) -> dict[str, Any]:
    coordinator, step = worlds.coordinator.model, int(worlds.ticks[0]) - 1
    return {
        "experiment": task.experiment,
        "scenario": task.scenario,
        "condition": task.condition,
        "seed": task.seed,
        "robot": robot,
        "step": step,
        "time_s": round(step * worlds.period, 9),
        "options": {coordinator.goal: coordinator.options[worlds.coordinator.held[robot]]},
    }


def as_json(situation: dict[str, Any], explanation: Explanation) -> str:
    """Return situation and explanation as a JSON object; without a plan, `plan` is null."""
    return json.dumps(situation | asdict(explanation), indent=2, allow_nan=False)


def on_terminal(situation: dict[str, Any], explanation: Explanation) -> RenderableType:
    """Return the explanation for a terminal of 80 columns or more."""
    run = "{experiment}, seed {seed}, {condition}, scenario {scenario}".format(**situation)
    options = "; ".join(f"{goal} by {option}" for goal, option in situation["options"].items())
    title = f"{run}\nrobot {situation['robot']} at {situation['time_s']:g} s (step {situation['step']}); {options}"
    due = f"step {explanation.plan_index + 1} of {len(explanation.plan)} is due" if explanation.plan else ""
    facts = Text(f"{title}\n\n" + "\n".join(filter(None, [*header(explanation), due])))
    trees = (_behaviours(explanation.behaviours), _goals(explanation.goals), _readings(explanation.readings))
    return Group(facts, Text(), _table(explanation.behaviours), Text(), *trees)


def _table(behaviours: Sequence[BehaviourAccount]) -> Table:
    """Return what the step added to each activation; * marks what runs."""
    table = Table(box=None, padding=(0, 1, 0, 0), pad_edge=False)
    table.add_column("", no_wrap=True)
    table.add_column("behaviour", overflow="fold")
    for head in ("active", *(HEADS.get(name, head) for name, head in COLUMNS.items())):
        table.add_column(head, justify="right", no_wrap=True)
    for account in behaviours:
        terms = [f"{account.components[name]:.2f}" for name in COLUMNS]
        table.add_row("*" if account.running else "", Text(account.name), f"{account.activation:.2f}", *terms)
    return table


def _behaviours(behaviours: Sequence[BehaviourAccount]) -> Tree:
    tree = Tree("behaviours, the most active first")
    for account in behaviours:
        branch = tree.add(Text(f"{'* ' if account.running else ''}{account.name}: {account.why}"))
        ready = "ready" if account.ready else "not ready"
        branch.add(Text(f"{ready}, satisfied {account.satisfaction:.3g}{_wishes(account)}"))
        _add_conditions(branch, account.conditions)
    return tree


def _goals(goals: Sequence[GoalAccount]) -> Tree:
    tree = Tree("goals")
    for account in goals:
        off = "" if account.enabled else " (off)"
        branch = tree.add(Text(f"{account.name}{off}: satisfied {account.satisfaction:.3g}{_wishes(account)}"))
        _add_conditions(branch, account.conditions)
    return tree


def _readings(readings: dict[str, float]) -> Tree:
    tree = Tree("readings")
    tree.add(Text(", ".join(f"{name} {value:.4g}" for name, value in readings.items())))
    return tree


def _add_conditions(branch: Tree, accounts: Sequence[ConditionAccount]) -> None:
    for account in accounts:
        _add_conditions(branch.add(Text(f"{account.label}: {account.satisfaction:.3g}")), account.parts)


def _wishes(account: BehaviourAccount | GoalAccount) -> str:
    wished = [f"{sensor} {wish:+.3g}" for sensor, wish in account.wishes if wish != 0.0]
    return f", wishes {', '.join(wished)}" if wished else ""


def record(task: RunTask, output: Path) -> int:
    """Repeat a whole run and keep every step of every robot in an NPZ file; return the number of steps (T)."""
    if output.exists():
        raise ConfigurationError(f"{output}: exists already; expected a new file")
    recorder = None
    for worlds in steps_of(task):
        recorder = recorder or Recorder(worlds.network)
        recorder.take()
    if recorder is None:
        raise ConfigurationError("the mission has nothing to do and is over at once")
    arrays: dict[str, Any] = stacked(recorder.steps) | _names(task, worlds)
    file = io.BytesIO()
    np.savez_compressed(file, **arrays)
    try:
        write_atomically(output, file.getvalue())
    except OSError as error:
        raise ConfigurationError(f"{output}: cannot be written ({error.strerror})") from error
    return len(recorder.steps)


def _names(task: RunTask, worlds: Worlds) -> dict[str, NDArray[Any]]:
    """Return what the axes of a recording mean."""
    model = worlds.network.model
    run = {"experiment": task.experiment, "scenario": task.scenario, "condition": task.condition, "seed": task.seed}
    return {
        "behaviour_names": np.array([behaviour.name for behaviour in model.behaviours]),
        "sensor_names": np.array([sensor.name for sensor in model.sensors]),
        "goal_names": np.array([goal.name for goal in model.goals]),
        "run": np.array(json.dumps(run | {"period_s": worlds.period})),
    }
