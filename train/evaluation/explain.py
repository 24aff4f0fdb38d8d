"""Explanation of one step of one robot: activations, plan, running behaviours and reasons.

The text fits into 80 columns: a table of the terms of each activation, and a tree of reasons, conditions and goals.
"""

import json
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any, Final

import numpy as np
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.deciders.strategies import PolicyDecider
from clean_swarm_env.deciders.what_if import WhatIf
from clean_swarm_env.world.explaining import Coordinated, Nested, RobotStep, explain_robot
from selforg.arrays import Flags
from selforg.network.explanation import Explanation, condition_tree, header, table
from selforg.space import Torus
from train.evaluation.repeat import Deciding, steps_until
from train.evaluation.why import facts_of, sentence
from train.running.trial_task import TrialTask

STATES: Final = {"failed": "it has failed: its body stays", "taken away": "it has been taken away"}
"""What is said of a robot that is not at work."""
STILL: Final = 0.1
"""Distance within which a robot stays where it is, as in `mind.js` of the replay page [m]."""
SHORTEST_STAY: Final = 1.0
"""What is shorter is no stay [s]."""
Inside = Coordinated | Nested


def explained(
    task: TrialTask, robot: int, time: float, *, ahead: bool = False
) -> tuple[dict[str, Any], RobotStep, dict[str, Any]]:
    """Repeat a run up to `time` [s]; return what run it is, what the robot decided then, and what led to it.

    The latter is `stayed_s`, how long the robot has stayed within `STILL` of where it is [s], and `running_s`, how long
    each behaviour that runs has been running, the step included [s]; beside it the `sentence`, the `facts` in it, and
    what a `policy` saw of the robot; with `ahead`, the next seconds under each option, `what_if`.
    """
    count = task.first.mission.rows
    if not 0 <= robot < count:
        raise ConfigurationError(f"--robot: expected a number from 0 to {count - 1}, got {robot}")
    names = {"experiment": task.experiment, "scenario": task.first.id, "condition": task.condition, "seed": task.seed}
    places, running = [np.array(place[:2]) for place in task.first.start.robots[robot : robot + 1]], []
    unseen: list[bool] = []
    latest: list[Deciding] = []
    for worlds in steps_until(task, time, latest):
        if robot >= worlds.team.joined[0]:
            continue
        if not places:  # it has just joined
            places.append(worlds.minds.poses.positions[robot].copy())
        places.append(worlds.physics.positions[robot].copy())
        running.append(worlds.network.executing[robot] == 1)
        seen = worlds.network.model.sensor_index.get(worlds.task.sees, -1)
        unseen.append(seen < 0 or worlds.network.readings[robot, seen] == 0.0)
    step, period = explain_robot(worlds, robot), worlds.period
    ways = Torus(*worlds.extent).offsets(places[-2], np.array(places[:-1]))
    stayed = _latest(np.linalg.norm(ways, axis=1) < STILL) - 1
    ran = {
        behaviour.name: round(_latest(np.array(running)[:, b]) * period, 9)
        for b, behaviour in enumerate(worlds.network.model.behaviours)
        if running[-1][b]
    }
    facts = facts_of(worlds, step, round(_latest(np.array(unseen)) * period, 9))
    told: dict[str, Any] = {"sentence": sentence(facts, type(worlds.task)), "facts": asdict(facts), "policy": {}}
    for one in latest:
        told["policy"] = one.decider.moves(robot) if isinstance(one.decider, PolicyDecider) else {}
    if ahead:
        (one,) = latest
        what_if = WhatIf(one.batch, one.decided, task.settings.observation, task.directories)
        told["what_if"] = what_if.options(robot, one.decider, one.observations, np.full(count, -1))
    return names, step, {"stayed_s": round(stayed * period, 9), "running_s": ran, **told}


def _latest(held: Flags) -> int:
    """Return for how many of the latest steps (T,) something has held."""
    return len(held) - 1 - int(np.flatnonzero(~held).max(initial=-1))


def as_json(names: dict[str, Any], step: RobotStep, before: dict[str, Any]) -> str:
    """Return a step as a JSON object; `plan` is null without a plan, `inner` if the network inside does not run."""
    return json.dumps(names | step.as_mapping() | before, indent=2, allow_nan=False)


def step_on_terminal(names: dict[str, Any], step: RobotStep, before: dict[str, Any]) -> RenderableType:
    """Return the explanation for a terminal of 80 columns or more."""
    explanation, situation = step.network, names | step.as_mapping()
    inside: tuple[Inside, ...] = (*step.coordinators, *step.networks)
    run = "{experiment}, seed {seed}, {condition}, scenario {scenario}".format(**situation)
    options = "; ".join(f"{goal} by {option}" for goal, option in situation["options"].items())
    title = f"{run}\nrobot {situation['robot']} at {situation['time_s']:g} s (step {situation['step']}); {options}"
    due = f"step {explanation.plan_index + 1} of {len(explanation.plan)} is due" if explanation.plan else ""
    stayed = f"it has stayed within {STILL:g} m for {before['stayed_s']:g} s"
    told = [
        f"it {before['sentence']}",
        *(_moved(goal, move) for goal, move in before["policy"].items()),
        STATES.get(step.state, stayed if before["stayed_s"] >= SHORTEST_STAY else ""),
        "; ".join(f"{name} has run for {seconds:g} s" for name, seconds in before["running_s"].items()),
        f"a collision stops it for {situation['stopped_s']:g} s, this step included" if situation["stopped_s"] else "",
        *header(explanation),
        due,
    ]
    facts = Text(f"{title}\n\n" + "\n".join(filter(None, told)))
    read = ", ".join(f"{name} {value:.4g}" for name, value in explanation.readings.items())
    tree = Text("\n".join([*condition_tree(explanation), f"readings: {read}"]))
    ahead = [_foretold(before["what_if"])] if "what_if" in before else []
    inner = [part for one in inside if one.inner for part in _inside(one.title, one.inner)]
    return Group(facts, Text(), *ahead, Text("\n".join(table(explanation.behaviours))), Text(), tree, *inner)


def _foretold(options: Sequence[dict[str, Any]]) -> Table:
    """Return a table of what happens next under each option."""
    table = Table(
        title=f"the next {options[0]['seconds']:g} s if it took", box=None, title_justify="left", pad_edge=False
    )
    figures = [one.get("measures") or {"items dumped": one["items"]} for one in options]
    for head in ("option", "own collisions", "collisions", *figures[0], "cost s"):
        table.add_column(head, justify="left" if head == "option" else "right", no_wrap=True)
    for one, own in zip(options, figures, strict=True):
        counts = (one["own_collisions"], one["collisions"], *(f"{value:.3g}" for value in own.values()))
        table.add_row(Text(one["option"]), *map(str, counts), f"{one['cost_s']:.1f}")
    return table


def _moved(goal: str, move: dict[str, Any]) -> str:
    """Return which input moved the choice of a policy most."""
    name = max(move["moved"], key=lambda one: abs(move["moved"][one]))
    without = move["probability"] - move["moved"][name]
    likely = f"{goal}: {move['option']} has {move['probability']:.0%}"
    return f"{likely}; {name} = {move['inputs'][name]:.2f} moved it most, at its mean {without:.0%}"


def _inside(title: str, inner: Explanation) -> list[RenderableType]:
    """Return the step of a network inside a behaviour as text."""
    return [Text(f"\ninside {title}"), Text("\n".join(table(inner.behaviours))), Text("\n".join(condition_tree(inner)))]
