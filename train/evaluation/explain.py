"""Explanation of one step of one robot: activations, plan, running behaviours and reasons.

The text fits into 80 columns: a table of the terms of each activation, and a tree of reasons, conditions and goals.
"""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text
from rich.tree import Tree

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.world.worlds import Worlds
from selector.coordination.coordinator import Coordinator
from selector.coordination.inner_network import InnerNetwork, at_any_depth
from selforg.network.explain.explanation import BehaviourAccount, ConditionAccount, Explanation, GoalAccount, explain
from selforg.network.explain.recording import Recorder
from selforg.network.explain.text import TERM_TITLES, header
from selforg.network.network import BehaviourNetwork
from train.evaluation.repeat import Repeated, world_at

HEADS = {"goal_inhibition": "inhib.", "predecessors": "pred.", "successors": "succ.", "conflictors": "confl."}
"""Short heads of columns, so that the table fits."""


@dataclass(frozen=True)
class Coordinated:
    """One coordinator of a robot in one step: its option, and the step of the network inside if it ran."""

    goal: str
    option: str
    inner: Explanation | None

    @property
    def title(self) -> str:
        """Goal and option."""
        return f"{self.goal}: {self.option}"


@dataclass(frozen=True)
class Nested:
    """One network inside a behaviour of a robot in one step; the title names the behaviours around it."""

    title: str
    inner: Explanation | None


Inside = Coordinated | Nested


def explained(task: Repeated, robot: int, time: float) -> tuple[dict[str, Any], Explanation, tuple[Inside, ...]]:
    """Repeat a run up to `time` [s]; return robot and step as a mapping, the explanation, and the networks inside."""
    count = task.mission.robots.count
    if not 0 <= robot < count:
        raise ConfigurationError(f"--robot: expected a number from 0 to {count - 1}, got {robot}")
    worlds = world_at(task, time)
    coordinated = (_coordinated(coordinator, robot) for coordinator in worlds.coordinators)
    nested = (Nested(one.name, _inner_step(one, one.network, robot)) for one in at_any_depth(worlds.minds.nested))
    return _situation(task, worlds, robot), _step_of(worlds.network, robot), (*coordinated, *nested)


def _step_of(network: BehaviourNetwork, robot: int) -> Explanation:
    return explain(network.model, Recorder(network, np.array([robot])).take(), robot)


def _coordinated(coordinator: Coordinator, robot: int) -> Coordinated:
    option = int(coordinator.held[robot])
    network = coordinator.contents[option].network
    inner = _step_of(network, robot) if coordinator.beside[option] else _inner_step(coordinator, network, robot)
    return Coordinated(coordinator.model.goal, coordinator.model.options[option], inner)


def _inner_step(holder: Coordinator | InnerNetwork, network: BehaviourNetwork, robot: int) -> Explanation | None:
    """Return the step of a network inside a behaviour; None if the behaviour does not run."""
    return _step_of(network, robot) if holder.parent.executing[robot, holder.index] == 1 else None


def _situation(task: Repeated, worlds: Worlds, robot: int) -> dict[str, Any]:
    step, consequences = int(worlds.ticks[0]) - 1, worlds.floor.consequences
    return {
        "experiment": task.experiment,
        "scenario": task.scenario,
        "condition": task.condition,
        "seed": task.seed,
        "robot": robot,
        "step": step,
        "time_s": round(step * worlds.period, 9),
        "stopped_s": round(int(consequences.standing[robot]) * worlds.period, 9),
        "damaged": bool(consequences.damaged[robot]),
        "options": {c.model.goal: c.model.options[c.held[robot]] for c in worlds.coordinators},
    }


def as_json(situation: dict[str, Any], explanation: Explanation, inside: Sequence[Inside]) -> str:
    """Return a step as a JSON object; `plan` is null without a plan, `inner` if the network inside does not run."""
    held = {
        "coordinators": [asdict(one) for one in inside if isinstance(one, Coordinated)],
        "networks": [asdict(one) for one in inside if isinstance(one, Nested)],
    }
    return json.dumps(situation | asdict(explanation) | held, indent=2, allow_nan=False)


def step_on_terminal(situation: dict[str, Any], explanation: Explanation, inside: Sequence[Inside]) -> RenderableType:
    """Return the explanation for a terminal of 80 columns or more."""
    run = "{experiment}, seed {seed}, {condition}, scenario {scenario}".format(**situation)
    options = "; ".join(f"{goal} by {option}" for goal, option in situation["options"].items())
    title = f"{run}\nrobot {situation['robot']} at {situation['time_s']:g} s (step {situation['step']}); {options}"
    due = f"step {explanation.plan_index + 1} of {len(explanation.plan)} is due" if explanation.plan else ""
    stopped = "a collision stops it for {stopped_s:g} s, this step included" if situation["stopped_s"] else ""
    damaged = "collisions have damaged it" if situation["damaged"] else ""
    facts = Text(
        f"{title}\n\n" + "\n".join(filter(None, [stopped.format(**situation), damaged, *header(explanation), due]))
    )
    trees = (_behaviours(explanation.behaviours), _goals(explanation.goals), _readings(explanation.readings))
    inner = [part for one in inside if one.inner for part in _inside(one.title, one.inner)]
    return Group(facts, Text(), _table(explanation.behaviours), Text(), *trees, *inner)


def _inside(title: str, inner: Explanation) -> list[RenderableType]:
    """Return the step of a network inside a behaviour as text."""
    return [Text(f"\ninside {title}"), _table(inner.behaviours), _behaviours(inner.behaviours)]


def _table(behaviours: Sequence[BehaviourAccount]) -> Table:
    """Return a table of what the step added to each activation; * marks running behaviours."""
    table = Table(box=None, padding=(0, 1, 0, 0), pad_edge=False)
    table.add_column("", no_wrap=True)
    table.add_column("behaviour", overflow="fold")
    for head in ("active", *(HEADS.get(name, head) for name, head in TERM_TITLES.items())):
        table.add_column(head, justify="right", no_wrap=True)
    for account in behaviours:
        terms = [f"{account.components[name]:.2f}" for name in TERM_TITLES]
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
