"""Arrays of the worlds that are copied in every frame, and the channels that are made of them.

Shapes: W worlds, N robots a world, R = W * N rows, M items a world, O options, B behaviours, S sensors, G goals.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from clean_swarm_env.recording.channels import MILLI, AnyArray, Channel, Part, point_channels, same, whole_channel
from clean_swarm_env.world.worlds import Worlds
from selector.coordination.inner_network import at_any_depth
from selforg.network.explain.explanation import in_short
from selforg.network.model.conditions import Condition, Optional, Tree
from selforg.network.network import BehaviourNetwork
from selforg.network.state import plan_state as ps
from selforg.network.state import state as st
from selforg.network.state.reasons import WORDS

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


@dataclass(frozen=True)
class Sampled:
    """An array that is copied in every frame."""

    array: AnyArray
    """(R, ...) or (W, ...), the same array all the time."""
    parts: tuple[Part, ...]
    kept: type[np.generic] | None = None
    """Type of the copies, where it is smaller than that of the array."""
    option: tuple[int, int] | None = None
    """The coordinator and its option to which the array belongs: it changes only while a robot holds the option."""


def floor_arrays(worlds: Worlds) -> Iterator[Sampled]:
    """Yield the arrays of items, stations, cargo, contacts and held options; the recorder keeps the poses itself."""
    robots, items = ("robot", worlds.robots), ("item", worlds.garbage.stage.shape[1])
    garbage, team = worlds.garbage, worlds.team
    for name, array, about in (
        ("present", worlds.physics.present, "1 where the robot is there, at work or failed"),
        ("working", team.working, "1 where the robot is at work"),
        ("cargo", garbage.cargo, "the item that the robot carries, -1 for none"),
        ("recycled", garbage.recycled, "1 where the cargo has been recycled"),
        ("contact", worlds.collisions.entered_in_tick, "robots that came too close until the next frame"),
    ):
        yield Sampled(array, ((whole_channel(name, robots, about), same),), np.int32)
    if worlds.floor.consequences.active:
        for name, array, about in (
            (
                "standing",
                worlds.floor.consequences.standing,
                "frames for which a collision stops the robot, this one too",
            ),
            ("collisions", worlds.floor.consequences.collisions, "collisions of the robot since it was as new"),
        ):
            yield Sampled(array, ((whole_channel(name, robots, about), same),), np.int32)
    yield Sampled(garbage.positions, tuple(point_channels("item", (items,), "where the item lies or was picked")))
    yield Sampled(
        garbage.stage, ((whole_channel("item_stage", items, "0 lying, 1 carried, 2 dumped, 3 absent"), same),), np.int16
    )
    leftover = whole_channel("item_leftover", items, "1 where what lies has been recycled already")
    yield Sampled(garbage.leftover, ((leftover, same),), np.int16)
    yield Sampled(worlds.stations, tuple(point_channels("station", (("station", 2),), "recycling and dump")))
    for coordinator in worlds.coordinators:
        held = whole_channel(f"held/{coordinator.model.goal}", robots, "the option that serves the goal in the robot")
        yield Sampled(coordinator.held, ((held, same),), np.int16)


def mind_arrays(worlds: Worlds) -> Iterator[Sampled]:
    """Yield what the networks of explained worlds read, computed and decided, those inside behaviours included."""
    yield from _network(worlds, "robot", worlds.network)
    for number, coordinator in enumerate(worlds.coordinators):
        for k, content in enumerate(coordinator.contents):
            prefix = f"{coordinator.model.goal}/{coordinator.model.options[k]}"
            yield from _network(worlds, prefix, content.network, (number, k))
    for nested in at_any_depth(worlds.minds.nested):
        yield from _network(worlds, nested.name, nested.network)


def networks_of(worlds: Worlds) -> dict[str, Any]:
    """Return what the head says about networks: names along the axes of their channels, and the words of reasons."""
    found = {"robot": worlds.network}
    for c in worlds.coordinators:
        names = zip(c.model.options, c.contents, strict=True)
        found |= {f"{c.model.goal}/{name}": content.network for name, content in names}
    found |= {nested.name: nested.network for nested in at_any_depth(worlds.minds.nested)}
    return {
        "terms": BEHAVIOUR_TERMS,
        "reasons": [WORDS[code] for code in range(len(WORDS))],
        "networks": {prefix: _described(network) for prefix, network in found.items()},
    }


def _layer(layer: int) -> Callable[[AnyArray], AnyArray]:
    return lambda values: values[:, :, layer]


def _of_plan(layer: int) -> Callable[[AnyArray], AnyArray]:
    return lambda marks: np.where(marks[:, :, ps.KNOWN] == 1, marks[:, :, layer], -1)


def _network(
    worlds: Worlds, prefix: str, network: BehaviourNetwork, option: tuple[int, int] | None = None
) -> Iterator[Sampled]:
    """Yield the arrays of one network, under names that begin with `prefix`."""
    model, state, plans, robots = network.model, network.state, network.plans, worlds.robots
    behaviours = len(model.behaviours)

    def channel(name: str, axes: tuple[str, ...], shape: tuple[int, ...], scale: int, about: str) -> Channel:
        return Channel(f"{prefix}/{name}", ("robot", *axes), (robots, *shape), scale, 1, "-", about)

    terms = channel(
        "values", ("term", "behaviour"), (len(BEHAVIOUR_TERMS), behaviours), MILLI, "the terms of each behaviour"
    )
    marks = tuple(
        (channel(name, ("behaviour",), (behaviours,), 1, about), _layer(layer))
        for name, (layer, about) in MARKS.items()
    )
    about = "threshold, total activation before the step, and the threshold by which it decided"
    readings = channel("readings", ("sensor",), (len(model.sensors),), MILLI, "what the sensors read")
    yield Sampled(state.value_table, ((terms, same),), None, option)
    yield Sampled(state.mark_table, marks, np.int16, option)
    if option is None:  # the sensors of an option are among those of the robot
        thresholds = channel("thresholds", ("term",), (len(THRESHOLDS),), MILLI, about)
        yield Sampled(state.row_table, ((thresholds, same),))
        yield Sampled(state.readings, ((readings, same),))
    if model.goals:
        goals = channel("goals", ("goal",), (len(model.goals),), MILLI, "how far each goal is satisfied")
        yield Sampled(state.goal_satisfaction, ((goals, same),), None, option)
    if plans.packed.record.planned:
        steps = channel("plan", ("step",), (PLAN_STEPS,), 1, "behaviours of the plan; those after its end mean nothing")
        length = channel("plan_length", (), (), 1, "number of steps of the plan, -1 without one")
        due = channel("plan_due", (), (), 1, "the step that is due, -1 without a plan")
        yield Sampled(plans.steps[:, :PLAN_STEPS], ((steps, same),), np.int16, option)
        yield Sampled(plans.mark_table, ((length, _of_plan(ps.LENGTH)), (due, _of_plan(ps.INDEX))), np.int16, option)


def _described(network: BehaviourNetwork) -> dict[str, Any]:
    model = network.model
    return {
        "behaviours": [behaviour.name for behaviour in model.behaviours],
        "needs": [
            [
                [tag, condition.sensor, in_short(condition.activator)]
                for tag, interface in behaviour.interfaces
                for tree in interface.preconditions
                for condition in _leaves(tree.of if isinstance(tree, Optional) else tree)
            ]
            for behaviour in model.behaviours
        ],
        "sensors": [sensor.name for sensor in model.sensors],
        "goals": [goal.name for goal in model.goals],
    }


def _leaves(tree: Tree) -> Iterator[Condition]:
    if isinstance(tree, Condition):
        yield tree
        return
    for below in tree.of if isinstance(tree.of, tuple) else (tree.of,):
        yield from _leaves(below)
