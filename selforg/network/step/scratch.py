"""Scratch memory of a step: what one stage computes for the next ones, overwritten for each row."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from selforg.arrays import SCRATCH, Floats, Ints
from selforg.compiler.records import Packed, Recording
from selforg.network.model.packed import PackedModel

POSITIVE, NEGATIVE, EITHER, WISH_MORE, WISH_LESS, COUNTS = range(6)
"""Rows of counts: operational behaviours with an effect up, down, any; with a wish up, down."""


class Scratch(NamedTuple):
    """Memory overwritten for each row; S sensors, L leaves, C nodes, B behaviours, G goals, E effects, U wishes."""

    leaf_satisfaction: Annotated[Floats, "L", SCRATCH]
    leaf_wish: Annotated[Floats, "L", SCRATCH]
    node_satisfaction: Annotated[Floats, "C", SCRATCH]
    operational: Annotated[Ints, "B", SCRATCH]  # 1 where a behaviour is operational, see `sharing`
    live_effect: Annotated[Ints, "E", SCRATCH]  # 1 where an effect takes part, see `sharing`
    live_wish: Annotated[Ints, "U", SCRATCH]
    counts: Annotated[Ints, "COUNTS S", SCRATCH]
    goal_share: Annotated[Floats, "G", SCRATCH]  # factor on what each goal gives
    order: Annotated[Ints, "B", SCRATCH]  # behaviours in falling activation
    counted: Annotated[Ints, "B", SCRATCH]  # 1 where a behaviour takes one of the places of `max_parallel`


STEP_SCRATCH = Recording(Scratch)
open_scratch = STEP_SCRATCH.open


def scratch_for(model: PackedModel) -> Packed[Scratch]:
    """Return the scratch memory of a network."""
    sensors, behaviours, goals = len(model.is_fact), len(model.priority), len(model.goal_permanent)
    leaves, nodes = len(model.leaf_kind), len(model.node_kind)
    effects, wishes = len(model.effect_owner), len(model.wish_owner)
    return STEP_SCRATCH.pack(
        Scratch(
            leaf_satisfaction=np.zeros(leaves),
            leaf_wish=np.zeros(leaves),
            node_satisfaction=np.zeros(nodes),
            operational=np.zeros(behaviours, dtype=np.int64),
            live_effect=np.zeros(effects, dtype=np.int64),
            live_wish=np.zeros(wishes, dtype=np.int64),
            counts=np.zeros((COUNTS, sensors), dtype=np.int64),
            goal_share=np.zeros(goals),
            order=np.zeros(behaviours, dtype=np.int64),
            counted=np.zeros(behaviours, dtype=np.int64),
        )
    )
