"""The channels of worlds, and the arrays from which they are taken.

Shapes: W worlds, N robots a world, R = W * N rows, M items a world, O options, B behaviours, S sensors, G goals.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import partial
from typing import Any, Literal

import numpy as np

from clean_swarm_env.config.free_places import segments_of
from clean_swarm_env.recording.channels import MILLI, Channel, channel_of
from clean_swarm_env.recording.taking import Sampled
from clean_swarm_env.world.explaining import Movements
from clean_swarm_env.world.parts.shown import ROBOT, Shown
from clean_swarm_env.world.worlds import Worlds
from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import lean_kernel
from selforg.components.facts import SharedFact
from selforg.mechanisms.causes import MOST_CAUSES
from selforg.network import state as st
from selforg.network.explanation import in_short
from selforg.network.model.conditions import Optional, leaves
from selforg.network.network import BehaviourNetwork
from selforg.plugins import broken

BEHAVIOUR_TERMS = ("activation", "satisfaction", *st.COMPONENTS)
"""Terms of a behaviour, in the order of the layers of `state`."""
THRESHOLDS = ("threshold", "total", "deciding")
MARKS = {
    "present": (st.PRESENT, "1 where the behaviour is part of the network"),
    "running": (st.EXECUTING, "1 where the behaviour runs"),
    "ready": (st.READY, "1 where the behaviour is ready"),
    "reason": (st.REASON, "why it runs or does not: a key of `reasons` in the head"),
    "by": (st.BY, "the behaviour that the reason is about, -1 for none"),
}
PLAN_STEPS = 16
"""Steps of a plan that are kept."""


def check_shown(worlds: Worlds, shown: Iterable[Shown]) -> None:
    """Raise PluginError if the task shows other arrays than those that are recorded."""
    now = {one.name: one.values for one in worlds.task.shown()}
    for one in shown:
        if one.note is None and one.values.__array_interface__ != now[one.name].__array_interface__:
            raise broken(worlds.task, "shown", f"expected the same array all the time, got a new one of {one.name}")


def floor_arrays(worlds: Worlds, shown: Iterable[Shown]) -> Iterator[Sampled]:
    """Yield the arrays of robots, held options and what the task has shown; the recorder keeps the poses itself."""
    own = [
        Shown("present", ROBOT, worlds.physics.present, "1 where the robot is there, at work or failed"),
        Shown("working", ROBOT, worlds.team.working, "1 where the robot is at work"),
        Shown("contact", ROBOT, worlds.collisions.entered_in_tick, "robots that came too close until the next frame"),
    ]
    if worlds.task.priced:
        about = "pairs closer than the first collision distance, summed over the physics steps before the frame's end"
        own.append(Shown("samples", "distance", worlds.collisions.samples[:, :1], about))
    serves = "the option that serves the goal in the robot"
    own += [Shown(f"held/{c.model.goal}", ROBOT, c.held, serves) for c in worlds.coordinators]
    for one in (*own, *shown):
        axis = {one.axis: one.values.reshape(worlds.worlds, -1, *one.values.shape[2:]).shape[1]}
        if one.values.ndim == 3:
            yield from points(one.name, axis, one.values, one.about)
        else:
            yield Sampled(channel_of(one.name, axis, one.about), one.values, None, one.note)


def things_of(worlds: Worlds, world: int, *, moving: bool = False) -> Iterator[dict[str, Any]]:
    """Yield the things of a world as plain data; `moves` counts those that move, in the order of their channels.

    With `moving` all of them may.
    """
    count = 0
    for thing in worlds.task.around:
        places = thing.places[world]
        reaches = (np.broadcast_to(reach, len(places)).tolist() for reach in (thing.diffusion, thing.goal_radius))
        for (x, y), diffusion, radius in zip(places.tolist(), *reaches, strict=True):
            what = {"channel": thing.channel, "attraction": thing.attraction}
            yield {**what, "x": x, "y": y, "diffusion": diffusion, "radius": radius} | (
                {"moves": count} if thing.moves or moving else {}
            )
            count += thing.moves or moving


def walls_shown(worlds: Worlds) -> Floats:
    """Return x, y of either end of the walls (K, 4) [m]."""
    return segments_of(worlds.mission.world) + np.tile(worlds.floor.ground.corner, 2)


def zones_shown(worlds: Worlds) -> list[tuple[str, float, float, float, float]]:
    """Return name, lower left and upper right corner of each zone [m]."""
    x, y = worlds.floor.ground.corner.tolist()
    areas = [(zone.name, *zone.area[0], *zone.area[1]) for zone in worlds.mission.world.zones]
    return [(name, left + x, bottom + y, right + x, top + y) for name, left, bottom, right, top in areas]


def points(
    name: str, axes: Mapping[str, int], places: Floats, about: str, unit: str = "m", order: Literal[1, 2] = 1
) -> Iterator[Sampled]:
    """Yield the channels of the coordinates x and y of points or vectors (..., 2)."""
    for k, coordinate in enumerate("xy"):
        full = f"{name}_{coordinate}" if name else coordinate
        yield Sampled(channel_of(full, axes, about, MILLI, unit, order), places[..., k])


def mind_arrays(worlds: Worlds) -> Iterator[Sampled]:
    """Yield what the networks of rows read, computed and decided, those of options and inside behaviours included."""
    robots = worlds.robots
    yield from _movements(robots, Movements(worlds))
    yield from _network(robots, "robot", worlds.network)
    for number, coordinator in enumerate(worlds.coordinators):
        for k, content in enumerate(coordinator.contents):
            prefix = f"{coordinator.model.goal}/{coordinator.model.options[k]}"
            yield from _network(robots, prefix, content.network, (number, k))
    for nested in worlds.minds.nested:
        yield from _network(robots, nested.name, nested.network)
    for fact in worlds.minds.facts.values():
        yield from _heard(worlds, fact)


def _movements(robots: int, movements: Movements) -> Iterator[Sampled]:
    """Yield what robots were told to drive, what they wanted, and who counts; this one brings all up to date."""
    without = "the same without what keeps it away from others, 0 where that is all it does"
    yield from points("command", {ROBOT: robots}, movements.commands, "what the robot was told to drive", "m/s")
    yield from points("wish", {ROBOT: robots}, movements.wishes, without, "m/s")
    causes = {ROBOT: robots, "cause": MOST_CAUSES}
    about = "robots because of whom it does not do what it wanted, the one that counts most first; -1 for none"
    yield Sampled(channel_of("cause", causes, about), movements.who, prepare=movements.note)
    yield Sampled(channel_of("cause_share", causes, "how much each of them counts", MILLI), movements.shares)


def _heard(worlds: Worlds, fact: SharedFact) -> Iterator[Sampled]:
    """Yield what robots have heard of a fact; the first one brings all up to date."""
    each = {
        "age": (fact.ages, MILLI, "s", "time since it was told, -1 where nothing was heard"),
        "robot": (fact.robots, 1, "-", "who told it, -1 where nothing was heard"),
        "value": (fact.values, MILLI, "-", "the number that was told, 0 where nothing was heard"),
    }
    for name, (values, scale, unit, about) in each.items():
        channel = channel_of(f"heard/{fact.name}/{name}", {ROBOT: worlds.robots}, about, scale, unit)
        note = (lambda: fact.note(worlds.now - worlds.period)) if name == "age" else None
        yield Sampled(channel, values, prepare=note)


def networks_of(worlds: Worlds) -> dict[str, Any]:
    """Return the head's entries about networks: names along the axes of their channels, and what is said of robots."""
    found = {"robot": worlds.network}
    for c in worlds.coordinators:
        names = zip(c.model.options, c.contents, strict=True)
        found |= {f"{c.model.goal}/{name}": content.network for name, content in names}
    found |= {nested.name: nested.network for nested in worlds.minds.nested}
    task = worlds.task
    return {
        "task_words": {"doing": task.doing, "searching": task.searching, "sees": task.sees},
        "destinations": [one._asdict() for one in task.destinations()],
        "terms": BEHAVIOUR_TERMS,
        "reasons": [st.WORDS[code] for code in range(len(st.WORDS))],
        "networks": {prefix: _described(network) for prefix, network in found.items()},
    }


def _network(
    robots: int, prefix: str, network: BehaviourNetwork, option: tuple[int, int] | None = None
) -> Iterator[Sampled]:
    """Yield the arrays of one network, under names that begin with `prefix`."""
    model, state = network.model, network.state
    behaviours, terms = {"behaviour": len(model.behaviours)}, {"term": len(BEHAVIOUR_TERMS)}

    def channel(name: str, about: str, axes: Mapping[str, int], scale: int = 1) -> Channel:
        return channel_of(f"{prefix}/{name}", {ROBOT: robots, **axes}, about, scale)

    yield Sampled(channel("values", "the terms of each behaviour", terms | behaviours, MILLI), state.values, option)
    for name, (layer, about) in MARKS.items():
        yield Sampled(channel(name, about, behaviours), state.marks[:, layer], option)
    if option is None:  # the sensors of an option are among those of the robot
        sensors = {"sensor": len(model.sensors)}
        about = "threshold, total activation before the step, and the threshold by which it decided"
        yield Sampled(channel("thresholds", about, {"term": len(THRESHOLDS)}, MILLI), state.row_values)
        yield Sampled(channel("readings", "what the sensors read", sensors, MILLI), state.readings)
    if model.goals:
        goals = {"goal": len(model.goals)}
        yield Sampled(channel("goals", "how far each goal is satisfied", goals, MILLI), state.goal_satisfaction, option)
    if state.planned:
        about = "behaviours of the plan; those after its end mean nothing"
        known: Ints = np.zeros((len(state.plan_marks), 2), dtype=np.int64)
        note = partial(note_plans, state.plan_marks, known)
        yield Sampled(channel("plan", about, {"step": PLAN_STEPS}), state.plan[:, :PLAN_STEPS], option, note)
        yield Sampled(channel("plan_length", "number of steps of the plan, -1 without one", {}), known[:, 0], option)
        yield Sampled(channel("plan_due", "the step that is due, -1 without a plan", {}), known[:, 1], option)


@lean_kernel
def note_plans(marks: Ints, known: Ints) -> None:
    """Fill `known` (R, 2) with the length of each plan and its due step, -1 without a plan."""
    for row in range(len(marks)):
        planned = marks[row, st.PLAN_KNOWN] == 1
        known[row, 0] = marks[row, st.PLAN_LENGTH] if planned else -1
        known[row, 1] = marks[row, st.PLAN_INDEX] if planned else -1


def _described(network: BehaviourNetwork) -> dict[str, Any]:
    model = network.model
    return {
        "behaviours": [behaviour.name for behaviour in model.behaviours],
        "needs": [
            [
                [tag, leaf.condition.sensor, in_short(leaf.condition.activator)]
                for tag, interface in behaviour.interfaces
                for tree in interface.preconditions
                for leaf in leaves(tree.of if isinstance(tree, Optional) else tree)
            ]
            for behaviour in model.behaviours
        ],
        "sensors": [sensor.name for sensor in model.sensors],
        "goals": [goal.name for goal in model.goals],
    }
