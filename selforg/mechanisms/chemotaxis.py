"""Chemotaxis: towards the nearest attractive gradient, away from the repulsive ones."""

from selforg.mechanisms.base import RuleMechanism
from selforg.mechanisms.kernels.rules import chemotaxis_balch, chemotaxis_ge
from selforg.mechanisms.registry import MECHANISMS


@MECHANISMS.register
class ChemotaxisBalch(RuleMechanism):
    """Chemotaxis by the potentials of Balch & Hybinette (2000), doi:10.1109/ROBOT.2000.844042."""

    rule = chemotaxis_balch


@MECHANISMS.register
class ChemotaxisGe(RuleMechanism):
    """Chemotaxis by the potentials of Ge & Cui (2000), doi:10.1109/70.880813; without a goal by Balch repulsion."""

    rule = chemotaxis_ge
