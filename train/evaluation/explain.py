"""Explanation of one step of one robot: activations, plan, running behaviours and reasons.

The text fits into 80 columns: a table of the terms of each activation, and a tree of reasons, conditions and goals.
"""

import json
from collections.abc import Sequence
from dataclasses import asdict
from math import tau
from pathlib import Path
from typing import Any, Final

import numpy as np
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.deciders.strategies import PolicyDecider
from clean_swarm_env.deciders.what_if import WhatIf
from clean_swarm_env.recording.reader import RecordedMission
from clean_swarm_env.world.explaining import Coordinated, Nested, RobotStep, explain_robot
from clean_swarm_env.world.mission import period_of
from selforg.arrays import Flags
from selforg.network.explanation import Explanation, condition_tree, header, table
from selforg.space import Torus
from train.evaluation.repeat import record_run
from train.evaluation.why import SLOW, STRAIGHT, facts_of, sentence
from train.running.needs import most_numbers
from train.running.trial_task import TrialTask

STATES: Final = {"failed": "it has failed: its body stays", "taken away": "it has been taken away"}
"""What is said of a robot that is not at work."""
STILL: Final = 0.1
"""Distance within which a robot stays where it is, as in `mind.js` of the replay page [m]."""
SHORTEST_STAY: Final = 1.0
"""What is shorter is no stay [s]."""
MOST_TURNS: Final = 8
"""Turns of a robot that are listed."""
APART: Final = 2.0
"""Turns that are nearer to each other than this are one [s]."""


def explained(
    task: TrialTask, path: Path, robot: int, time: float, *, ahead: bool = False
) -> tuple[dict[str, Any], RobotStep, dict[str, Any]]:
    """Return what run a task is, what a robot decided in it at a time [s], and what led to it.

    The run is repeated up to this time, and recorded in `path`.

    The latter is `stayed_s`, how long the robot has stayed within `STILL` of where it is [s], and `running_s`, how long
    each behaviour that runs has been running, the step included [s]; beside it the `sentence`, the `facts` in it, and
    what a `policy` saw of the robot; with `ahead`, the next seconds under each option, `what_if`.
    """
    count = task.first.mission.rows
    check_robot(count, robot)
    names = {"experiment": task.experiment, "scenario": task.first.id, "condition": task.condition, "seed": task.seed}
    batch, decided, decider, observations = record_run(task, path, until=time)
    recording = RecordedMission(path, most=most_numbers())
    frame, period = frame_at_time(recording, time), recording.period
    now, there = recording.at(frame), recording["present"][: frame + 1].astype(np.bool_)
    worlds = batch.worlds
    step = explain_robot(worlds, robot)
    own = slice(int(there[:, robot].argmax()), frame + 1), robot  # since it joined
    places = np.stack([recording["x"][own], recording["y"][own]], axis=1)
    ways = Torus(*worlds.extent).offsets(places[-1], places)
    stayed = _latest(np.linalg.norm(ways, axis=1) < STILL) - 1
    running = recording["robot/running"][own] == 1
    behaviours = enumerate(worlds.network.model.behaviours)
    ran = {one.name: round(_latest(running[:, b]) * period, 9) for b, one in behaviours if running[-1, b]}
    seen = worlds.network.model.sensor_index.get(worlds.task.sees, -1)
    unseen = _latest((recording["robot/readings"][own][:, seen] == 0.0) | (seen < 0))
    facts = facts_of(worlds, step, now, round(unseen * period, 9))
    told: dict[str, Any] = {"sentence": sentence(facts, type(worlds.task)), "facts": asdict(facts), "policy": {}}
    if isinstance(decider, PolicyDecider) and task.named.mode != "velocity":
        inputs = zip(recording.head["inputs"], now["input"][robot].tolist(), strict=True)
        told["policy"] = decider.moves(dict(inputs), step.options)
    if ahead:
        what_if = WhatIf(batch, decided, task.settings.observation, task.directories)
        told["what_if"] = what_if.options(robot, decider, observations, np.full(count, -1))
    return names, step, {"stayed_s": round(stayed * period, 9), "running_s": ran, **told}


def largest_turns(recording: RecordedMission, robot: int) -> list[dict[str, float]]:
    """Return where the direction that a robot was told to drive changed most: `time_s`, and `turn_deg`, to the left.

    In the order of time; of those that are near each other the largest.
    """
    check_robot(recording.head["robots"], robot)
    for name in ("command_x", "command_y"):
        if name not in recording or recording.channels[name].axes != ("robot",):
            raise ConfigurationError(f"{recording.path}: channels: expected {name} with an axis robot, got none")
    x, y = recording["command_x"][:, robot], recording["command_y"][:, robot]
    turns = np.diff(np.arctan2(y, x), prepend=0.0)
    turns -= tau * np.round(turns / tau)
    told = np.hypot(x, y) > SLOW
    turns[~told | ~np.roll(told, 1)] = turns[0] = 0.0
    found: list[int] = []
    for frame in np.argsort(-np.abs(turns), kind="stable"):
        if abs(turns[frame]) > STRAIGHT and all(abs(frame - one) * recording.period >= APART for one in found):
            found.append(int(frame))
    return [
        {"time_s": round(frame * recording.period, 9), "turn_deg": round(float(np.degrees(turns[frame])), 1)}
        for frame in sorted(found[:MOST_TURNS])
    ]


def check_robot(count: int, robot: int) -> None:
    """Raise ConfigurationError for the number of a robot that is not among `count`."""
    if not 0 <= robot < count:
        raise ConfigurationError(f"--robot: expected a number from 0 to {count - 1}, got {robot}")


def turns_in_words(turns: Sequence[dict[str, float]], robot: int) -> str:
    """Return the largest turns of a robot as lines of text."""
    sides = ("right", "left")
    told = [f"{one['time_s']:8g} s  {abs(one['turn_deg']):3.0f} degrees {sides[one['turn_deg'] > 0]}" for one in turns]
    return "\n".join([f"largest turns of robot {robot}; --time says why it turned:", *(told or ["none"])])


def frame_at_time(recording: RecordedMission, time: float) -> int:
    """Return the number of the frame in which a time [s] lies.

    Raises:
        ConfigurationError: the mission was not running at this time; the text says when it ended.

    """
    frame, result = period_of(time, 1.0 / recording.period), recording.result
    if frame >= recording.frames:
        assert result is not None
        how = "was completed after" if result["completed"] else "ended uncompleted at its time limit of"
        raise ConfigurationError(f"--time {time:g}: this mission {how} {result['duration_s']:g} s")
    return frame


def _latest(held: Flags) -> int:
    """Return for how many of the latest steps (T,) something has held."""
    return len(held) - 1 - int(np.flatnonzero(~held).max(initial=-1))


def as_json(names: dict[str, Any], step: RobotStep, before: dict[str, Any]) -> str:
    """Return a step as a JSON object; `plan` is null without a plan, `inner` if the network inside does not run."""
    return json.dumps(names | step.as_mapping() | before, indent=2, allow_nan=False)


def step_on_terminal(names: dict[str, Any], step: RobotStep, before: dict[str, Any]) -> RenderableType:
    """Return the explanation for a terminal of 80 columns or more."""
    explanation, situation = step.network, names | step.as_mapping()
    inside: tuple[Coordinated | Nested, ...] = (*step.coordinators, *step.networks)
    run = "{experiment}, seed {seed}, {condition}, scenario {scenario}".format(**situation)
    options = "; ".join(f"{goal} by {option}" for goal, option in situation["options"].items())
    title = f"{run}\nrobot {situation['robot']} at {situation['time_s']:g} s (step {situation['step']}); {options}"
    steps, index = len(explanation.plan or ()), explanation.plan_index
    due = f"step {index + 1} of {steps} is due" if index < steps else "the plan is done" * bool(steps)
    stayed = f"it has stayed within {STILL:g} m for {before['stayed_s']:g} s"
    told = [
        f"it {before['sentence']}",
        *(f"it {report['sentence']}" for report in step.heard),
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
    likely = f"{goal}: {move['option']} {'was sampled, at' if move['sampled'] else 'has'} {move['probability']:.0%}"
    return f"{likely}; {name} = {move['inputs'][name]:.2f} moved it most, at its mean {without:.0%}"


def _inside(title: str, inner: Explanation) -> list[RenderableType]:
    """Return the step of a network inside a behaviour as text."""
    return [Text(f"\ninside {title}"), Text("\n".join(table(inner.behaviours))), Text("\n".join(condition_tree(inner)))]
