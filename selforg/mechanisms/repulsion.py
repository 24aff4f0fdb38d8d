"""Repulsion among robots: the two mechanisms that the paper compares."""

import numpy as np

from selforg.gradients.pair import Pair, repulsion_balch
from selforg.mechanisms.base import MECHANISMS
from selforg.mechanisms.formula import NeighbourMechanism
from selforg.mechanisms.movement import REPEL


@MECHANISMS.register
class RepulsionFernandez(NeighbourMechanism):
    """Repulsion of Fernandez-Marquez et al. (2013), doi:10.1007/s11047-012-9324-y.

    Beyond the own reach, but within the view distance, neighbours attract (Q5).
    """

    by_own_reach = True
    walls = REPEL

    @staticmethod
    def formula(pair: Pair) -> float:
        """Return the repulsion [m], without regard to the own goal radius; positive beyond the own reach."""
        clearance = pair.distance - pair.goal_radius
        if clearance > pair.view_distance:
            return 0.0
        if clearance <= 0.0:
            return -np.inf
        return -(pair.distance * (pair.own_reach - clearance) / clearance)


@MECHANISMS.register
class RepulsionGradient(NeighbourMechanism):
    """Balch & Hybinette repulsion from the neighbours, doi:10.1109/ROBOT.2000.844042; contact counts the own reach."""

    by_own_reach = True
    walls = REPEL

    @staticmethod
    def formula(pair: Pair) -> float:
        """Return the repulsion of a pair, whatever the sign of the gradient [-]."""
        return -repulsion_balch(pair)
