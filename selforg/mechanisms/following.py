"""Following: all gradients, or the one that a rule chooses, by the potentials of Balch & Hybinette (2000)."""

from selforg.compiler.decorators import part
from selforg.compiler.records import Handle, Written
from selforg.gradients.pair import (
    CHOOSE_FARTHEST,
    CHOOSE_LEAST_REACH,
    CHOOSE_MOST_REACH,
    CHOOSE_STRONGEST,
    Own,
    Pair,
    attraction_balch,
    choose,
    pair_at,
    repulsion_balch,
)
from selforg.gradients.store.records import Poses, Sight, Store, open_sight
from selforg.mechanisms.base import MECHANISMS
from selforg.mechanisms.formula import FormulaMechanism
from selforg.mechanisms.movement import (
    ATTRACTIVE_AND_NEAR_REPULSIVE,
    BY_ANY,
    BY_REPULSIVE,
    NOT_AT_ALL,
    OWN_GOAL_RADIUS,
    VIEW_DISTANCE,
    Rule,
    add,
    full_length,
    open_rule,
)
from selforg.mechanisms.repulsion import RepulsionGradient

AvoidAll = FormulaMechanism.variant(
    "AvoidAll",
    "Away from all gradients, whatever their sign.",
    formula=RepulsionGradient.formula,
    looks=(OWN_GOAL_RADIUS, OWN_GOAL_RADIUS, OWN_GOAL_RADIUS),
    wakes=BY_ANY,
    min_speed=0.1,
)
CollisionAvoidance = FormulaMechanism.variant(
    "CollisionAvoidance",
    "Away from all repulsive gradients; the others are ignored.",
    formula=RepulsionGradient.formula,
    looks=(OWN_GOAL_RADIUS, NOT_AT_ALL, NOT_AT_ALL),
    wakes=BY_REPULSIVE,
    min_speed=0.1,
)


@MECHANISMS.register
class FollowAll(FormulaMechanism):
    """Towards attractive and away from repulsive gradients; neutral ones alone are a movement of zero (B4)."""

    looks = ATTRACTIVE_AND_NEAR_REPULSIVE
    wakes = BY_ANY
    min_speed = 0.1

    @staticmethod
    def formula(pair: Pair) -> float:
        """Return the attraction or repulsion, by the sign of the gradient."""
        if pair.attraction >= 0.0:
            return pair.attraction * attraction_balch(pair)
        return -repulsion_balch(pair)


@MECHANISMS.register
class FollowStrongest(FormulaMechanism):
    """Towards (or away from) the strongest gradient: repulsions by their length, attractions by 1 - length."""

    chooses = CHOOSE_STRONGEST
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
        """Follow the gradient that is chosen; False if none is."""
        pairs = open_sight(sight).pairs
        chosen = choose(open_rule(rule).chooses, pairs, found, own)
        if chosen < 0:
            return False
        pair = pair_at(chosen, pairs, own)
        if pair.attraction == 0.0:
            return False
        length = attraction_balch(pair) if pair.attraction > 0.0 else -repulsion_balch(pair)
        add(chosen, length, full_length(chosen, sight), row, sight, rule)
        return True


FollowMin = FollowStrongest.variant(
    "FollowMin",
    "Towards the farthest attractive gradient: the one with the longest attraction.",
    chooses=CHOOSE_FARTHEST,
    looks=(NOT_AT_ALL, NOT_AT_ALL, VIEW_DISTANCE),
)
FollowMinReach = FollowMin.variant(
    "FollowMinReach", "Towards the attractive gradient of least reach.", chooses=CHOOSE_LEAST_REACH
)
FollowMaxReach = FollowMin.variant(
    "FollowMaxReach", "Towards the attractive gradient of most reach.", chooses=CHOOSE_MOST_REACH
)
