"""The records of a network model: the declared network as flat arrays, and scratch memory for a step.

The letters of its axes: S sensors, B behaviours, G goals, L leaves (conditions, equal ones once), C nodes (leaves and
what is composed of them), E effects, U wishes (a behaviour's or a goal's view of one leaf). Where an owner has several
entries, `..._first` says where those of owner k begin; those of owner k + 1 begin where they end. A *tag* is the
alternative of a coordinator to which an entry belongs, -1: it always holds.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from selforg.arrays import READ, SCRATCH, Floats, Ints
from selforg.compiler.records import Packed, opening

LEAF, NEGATION, CONJUNCTION, DISJUNCTION = range(4)
"""Kinds of nodes."""


class PackedModel(NamedTuple):
    """What compiled code knows about a network; `packer` fills it."""

    is_fact: Annotated[Ints, "S", READ]  # 1 for a fact, 0 for a number

    leaf_sensor: Annotated[Ints, "L", READ]
    leaf_kind: Annotated[Ints, "L", READ]  # of its activator
    leaf_a: Annotated[Floats, "L", READ]  # the activator's two parameters, in the sensor's unit
    leaf_b: Annotated[Floats, "L", READ]
    leaf_low: Annotated[Floats, "L", READ]  # satisfaction when it is not fulfilled, and when it is
    leaf_high: Annotated[Floats, "L", READ]
    leaf_direction: Annotated[Floats, "L", READ]  # sign of the wanted change

    node_kind: Annotated[Ints, "C", READ]  # LEAF, NEGATION, CONJUNCTION or DISJUNCTION; children come before parents
    node_first: Annotated[Ints, "C+1", READ]  # into node_child
    node_child: Annotated[Ints, "CHILD", READ]  # node; of a LEAF node the leaf

    precondition_first: Annotated[Ints, "B+1", READ]  # into the next two; optional preconditions are left out
    precondition_node: Annotated[Ints, "PRECONDITION", READ]
    precondition_tag: Annotated[Ints, "PRECONDITION", READ]
    ready_threshold: Annotated[Floats, "B", READ]
    priority: Annotated[Ints, "B", READ]  # at the start
    interruptable: Annotated[Ints, "B", READ]  # 1 if it may be stopped
    timeout: Annotated[Ints, "B", READ]  # [steps], -1: never
    independent: Annotated[Ints, "B", READ]  # 1 if it is left out of planning

    effect_first: Annotated[Ints, "B+1", READ]  # into the next four
    effect_owner: Annotated[Ints, "E", READ]  # behaviour
    effect_sensor: Annotated[Ints, "E", READ]
    effect_tag: Annotated[Ints, "E", READ]
    effect_change: Annotated[Floats, "E", READ]

    goal_first: Annotated[Ints, "G+1", READ]  # into goal_node
    goal_node: Annotated[Ints, "CONDITION", READ]
    goal_permanent: Annotated[Ints, "G", READ]  # 0: it switches off when it is satisfied
    goal_threshold: Annotated[Floats, "G", READ]  # satisfaction from which it is satisfied
    goal_priority: Annotated[Floats, "G", READ]

    wish_first: Annotated[Ints, "B+G+1", READ]  # into the next four; behaviours, then goals
    wish_owner: Annotated[Ints, "U", READ]  # behaviour, or B + goal
    wish_sensor: Annotated[Ints, "U", READ]
    wish_leaf: Annotated[Ints, "U", READ]
    wish_tag: Annotated[Ints, "U", READ]
    wish_optional: Annotated[Ints, "U", READ]  # 1 for a wish of an optional precondition
    turn_first: Annotated[Ints, "U+1", READ]  # into turn_direction
    turn_direction: Annotated[
        Floats, "TURN", READ
    ]  # wish of a satisfied leaf after each negation above it, innermost first

    sensor_effect_first: Annotated[Ints, "S+1", READ]  # into sensor_effect
    sensor_effect: Annotated[Ints, "E", READ]  # effects by sensor
    sensor_wish_first: Annotated[Ints, "S+1", READ]
    sensor_wish: Annotated[Ints, "WISH", READ]  # wishes of behaviours by sensor
    sensor_goal_wish_first: Annotated[Ints, "S+1", READ]
    sensor_goal_wish: Annotated[Ints, "WISH", READ]  # wishes of goals by sensor
    pairs: Annotated[Ints, "PAIR 5", READ]  # an effect and a wish about one sensor, their behaviours, and the sensor
    goal_pair_effect: Annotated[Ints, "PAIR", READ]  # an effect and a wish of a goal about one sensor, by sensor
    goal_pair_wish: Annotated[Ints, "PAIR", READ]

    uniform: int  # 1: the "uniform" algorithm
    max_parallel: int  # 0: any number
    by_goal_priority: int  # 1: priorities of goals scale what they give
    strict_progress: int  # 1: a step of a plan is passed when its effects were seen
    situation_weight: float
    goal_weight: float
    conflictor_weight: float
    predecessor_weight: float
    successor_weight: float
    plan_weight: float
    activation_decay: float
    activation_threshold: float  # at the start
    threshold_decay: float


open_model = opening(PackedModel)


SENSE_AND_DECIDE, DECIDE_ONLY = range(2)
"""Phases of a step: the whole step, or the rest of it after a missing plan was made."""
POSITIVE, NEGATIVE, EITHER, COUNTS = range(4)
"""Rows of counts: operational behaviours with an effect up, down, any."""


class Scratch(NamedTuple):
    """A way to decide, and memory overwritten for each row, or for one that differs from the row before.

    The axes are those of the model.
    """

    phase: int  # SENSE_AND_DECIDE or DECIDE_ONLY
    guarantee: int  # 1: selection is repeated until some behaviour runs, or none is able to
    leaf_satisfaction: Annotated[Floats, "L", SCRATCH]
    leaf_wish: Annotated[Floats, "L", SCRATCH]
    node_satisfaction: Annotated[Floats, "C", SCRATCH]
    shown: Annotated[Ints, "B", SCRATCH]  # marks of each behaviour from which the next three follow
    operational: Annotated[Ints, "B", SCRATCH]  # 1 where a behaviour is operational
    live_effect: Annotated[Ints, "E", SCRATCH]  # 1 where an effect takes part
    counts: Annotated[Ints, "COUNTS S", SCRATCH]
    goal_share: Annotated[Floats, "G", SCRATCH]  # factor on what each goal gives
    order: Annotated[Ints, "B", SCRATCH]  # behaviours in falling activation
    counted: Annotated[Ints, "B", SCRATCH]  # 1 where a behaviour takes one of the places of `max_parallel`


open_scratch = opening(Scratch)


def scratch_for(model: PackedModel, phase: int, guarantee: int) -> Packed[Scratch]:
    """Return a way to decide of a network, with its scratch memory."""
    sensors, behaviours, goals = len(model.is_fact), len(model.priority), len(model.goal_permanent)
    leaves, nodes = len(model.leaf_kind), len(model.node_kind)
    effects = len(model.effect_owner)
    return Packed(
        Scratch(
            phase=phase,
            guarantee=guarantee,
            leaf_satisfaction=np.zeros(leaves),
            leaf_wish=np.zeros(leaves),
            node_satisfaction=np.zeros(nodes),
            shown=np.full(behaviours, -1, dtype=np.int64),
            operational=np.zeros(behaviours, dtype=np.int64),
            live_effect=np.zeros(effects, dtype=np.int64),
            counts=np.zeros((COUNTS, sensors), dtype=np.int64),
            goal_share=np.zeros(goals),
            order=np.zeros(behaviours, dtype=np.int64),
            counted=np.zeros(behaviours, dtype=np.int64),
        )
    )
