"""Chemotaxis: towards the nearest attractive gradient, away from the repulsive ones."""

from selforg.mechanisms.base import RuleMechanism
from selforg.mechanisms.kernels.rules import CHEMOTAXIS_BALCH, CHEMOTAXIS_GE
from selforg.mechanisms.registry import MECHANISMS


@MECHANISMS.register
class ChemotaxisBalch(RuleMechanism):
    """Chemotaxis by the potentials of Balch & Hybinette (2000), doi:10.1109/ROBOT.2000.844042."""

    rule = CHEMOTAXIS_BALCH


@MECHANISMS.register
class ChemotaxisGe(RuleMechanism):
    """Chemotaxis by the potentials of Ge & Cui (2000), doi:10.1109/70.880813; without a goal by Balch repulsion."""

    rule = CHEMOTAXIS_GE
