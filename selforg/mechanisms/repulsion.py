"""Repulsion among robots: the two mechanisms that the paper compares."""

from typing import Unpack

import numpy as np

from selforg.gradients.buffer import SoBuffer
from selforg.gradients.pair import Pair, repulsion_balch
from selforg.gradients.poses import OwnPoses
from selforg.gradients.store.columns import SKIP_OWN
from selforg.mechanisms.base import MECHANISMS, MoveOptions
from selforg.mechanisms.formula import FormulaMechanism


class Repulsion(FormulaMechanism):
    """What both share: they look at the neighbours' moving gradients and answer with at most the own reach.

    channels: those of the neighbours' gradients; by default the channel of the poses.
    """

    by_own_reach = True

    def __init__(self, buffer: SoBuffer | OwnPoses, **options: Unpack[MoveOptions]) -> None:
        poses = buffer if isinstance(buffer, OwnPoses) else buffer.poses
        options["channels"] = tuple(options.get("channels", ())) or (poses.channel,)
        options["static"] = False
        super().__init__(buffer, **options)
        self._see_bits |= SKIP_OWN


@MECHANISMS.register
class RepulsionFernandez(Repulsion):
    """Repulsion of Fernandez-Marquez et al. (2013), doi:10.1007/s11047-012-9324-y.

    Beyond the own reach, but within the view distance, neighbours attract (Q5).
    """

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
class RepulsionGradient(Repulsion):
    """Balch & Hybinette repulsion from the neighbours, doi:10.1109/ROBOT.2000.844042; contact counts the own reach."""

    @staticmethod
    def formula(pair: Pair) -> float:
        """Return the repulsion of a pair, whatever the sign of the gradient [-]."""
        return -repulsion_balch(pair)
