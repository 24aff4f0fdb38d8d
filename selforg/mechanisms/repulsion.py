"""Repulsion among robots: the two mechanisms that the paper compares."""

from typing import Unpack

from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.gradients.store.columns import SKIP_OWN
from selforg.mechanisms.base import RuleMechanism
from selforg.mechanisms.kernels.rules import fernandez, repulsion
from selforg.mechanisms.options import MoveOptions
from selforg.mechanisms.registry import MECHANISMS


class Repulsion(RuleMechanism):
    """What both share: they look at the neighbours' moving gradients and answer with at most the own reach.

    channels: those of the neighbours' gradients; by default the channel of the poses.
    """

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

    rule = fernandez


@MECHANISMS.register
class RepulsionGradient(Repulsion):
    """Balch & Hybinette repulsion from the neighbours, doi:10.1109/ROBOT.2000.844042; contact counts the own reach."""

    rule = repulsion
