"""Chemotaxis: towards the nearest attractive gradient, away from the repulsive ones."""

import numpy as np

from selforg.compiler.decorators import part
from selforg.compiler.records import Handle, Written
from selforg.gradients.pair import CHOOSE_NEAREST, Own, Pair, attraction_balch, choose, pair_at, repulsion_balch
from selforg.gradients.store.records import Poses, Sight, Store, open_sight
from selforg.mechanisms.base import MECHANISMS
from selforg.mechanisms.formula import FormulaMechanism
from selforg.mechanisms.movement import ATTRACTIVE_AND_NEAR_REPULSIVE, BY_REPULSIVE, Rule, add, full_length


@part
def attraction_ge(pair: Pair) -> float:
    """Return the attraction [m] of Ge & Cui (2000), doi:10.1109/70.880813."""
    if pair.clearance <= 0.0:
        return 0.0
    if pair.clearance <= pair.diffusion:
        return pair.clearance
    return pair.diffusion if pair.diffusion > 0.0 else 1.0


@part
def repulsion_ge(pair: Pair, goal_clearance: float) -> tuple[float, float]:
    """Return the repulsion of Ge & Cui (2000), doi:10.1109/70.880813: away from the obstacle, towards the goal.

    The part towards the goal does not depend on the distance of the goal, and inside the goal area
    (`goal_clearance` < 0) the first part attracts, as in the original (Q31). (infinite, 0) = full.
    """
    if pair.clearance <= 0.0:
        return np.inf, 0.0
    if pair.clearance > pair.diffusion:
        return 0.0, 0.0
    steepness = 1.0 / pair.clearance - 1.0 / pair.diffusion
    return steepness * goal_clearance / pair.clearance, 0.5 * steepness * steepness


@MECHANISMS.register
class ChemotaxisBalch(FormulaMechanism):
    """Chemotaxis by the potentials of Balch & Hybinette (2000), doi:10.1109/ROBOT.2000.844042."""

    looks = ATTRACTIVE_AND_NEAR_REPULSIVE
    wakes = BY_REPULSIVE
    min_speed = 0.1

    @staticmethod
    @part
    def combine(
        row: int,
        found: int,
        own: Own,
        sight: Handle[Sight],
        rule: Written[Rule],
        poses: Handle[Poses],
        store: Handle[Store],
    ) -> bool:
        """Add attraction to the nearest attractive gradient and all repulsions; False without any."""
        pairs = open_sight(sight).pairs
        goal = choose(CHOOSE_NEAREST, pairs, found, own)
        if goal >= 0:
            add(goal, attraction_balch(pair_at(goal, pairs, own)), 0.0, row, sight, rule)
        contributions = goal >= 0
        for index in range(found):
            pair = pair_at(index, pairs, own)
            if pair.attraction < 0.0:
                contributions = True
                add(index, -repulsion_balch(pair), full_length(index, sight), row, sight, rule)
        return contributions


balch = ChemotaxisBalch.combine


@MECHANISMS.register
class ChemotaxisGe(ChemotaxisBalch):
    """Chemotaxis by the potentials of Ge & Cui (2000), doi:10.1109/70.880813; without a goal by Balch repulsion."""

    @staticmethod
    @part
    def combine(
        row: int,
        found: int,
        own: Own,
        sight: Handle[Sight],
        rule: Written[Rule],
        poses: Handle[Poses],
        store: Handle[Store],
    ) -> bool:
        """Do as `ChemotaxisBalch` does; every repulsive gradient pushes towards the goal, too."""
        pairs = open_sight(sight).pairs
        goal = choose(CHOOSE_NEAREST, pairs, found, own)
        if goal < 0:
            return balch(row, found, own, sight, rule, poses, store)
        to = pair_at(goal, pairs, own)
        add(goal, attraction_ge(to), 0.0, row, sight, rule)
        for index in range(found):
            pair = pair_at(index, pairs, own)
            if pair.attraction < 0.0:
                away, to_goal = repulsion_ge(pair, to.clearance)
                if to.distance > 0.0:
                    add(goal, to_goal, 0.0, row, sight, rule)
                add(index, -away, full_length(index, sight), row, sight, rule)
        return True
