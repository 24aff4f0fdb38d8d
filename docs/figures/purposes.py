"""The patterns of self-organisation by purpose, as Fig. 1 of the paper groups them, with their mechanisms here.

The patterns are those of Fernandez-Marquez et al. (2013), doi:10.1007/s11047-012-9324-y. The paper sorts them by
purpose: basic functionality, which the buffer of gradients has; movement; decision. All movement and decision
patterns build on gradients.
"""

from dataclasses import dataclass
from enum import Enum


class Purpose(Enum):
    """What a pattern is for."""

    BASIC = "Basic functionality"
    MOVEMENT = "Movement"
    DECISION = "Decision"


@dataclass(frozen=True)
class Pattern:
    """A pattern of self-organisation.

    Attributes:
        name: of the pattern.
        purpose: what it is for.
        builds_on: names of other patterns.
        mechanisms: names of the registered mechanisms that realise it; none where the buffer of gradients does.

    """

    name: str
    purpose: Purpose
    builds_on: tuple[str, ...] = ()
    mechanisms: tuple[str, ...] = ()


PATTERNS = (
    Pattern("Spreading", Purpose.BASIC, (), ("SpreadGradient",)),
    Pattern("Aggregation", Purpose.BASIC),
    Pattern("Evaporation", Purpose.BASIC),
    Pattern("Gradients", Purpose.BASIC, ("Spreading", "Aggregation", "Evaporation")),
    Pattern("Repulsion", Purpose.MOVEMENT, ("Gradients",), ("RepulsionFernandez", "RepulsionGradient")),
    Pattern(
        "Collision avoidance",
        Purpose.MOVEMENT,
        ("Gradients",),
        ("CollisionAvoidance", "AvoidAll", "PredictiveSteering", "ORCA"),
    ),
    Pattern(
        "Chemotaxis",
        Purpose.MOVEMENT,
        ("Gradients",),
        (
            "ChemotaxisBalch",
            "ChemotaxisGe",
            "FollowAll",
            "FollowStrongest",
            "FollowMin",
            "FollowMinReach",
            "FollowMaxReach",
            "ApproachLeastBusy",
        ),
    ),
    Pattern("Flocking", Purpose.MOVEMENT, ("Gradients", "Repulsion"), ("Flocking", "FlockingReynolds")),
    Pattern(
        "Digital pheromones",
        Purpose.MOVEMENT,
        ("Gradients", "Chemotaxis"),
        ("DepositPheromones", "DepositPheromonesMin", "DepositPheromonesRandom", "Exploration", "Exploitation"),
    ),
    Pattern("Patrol", Purpose.MOVEMENT, ("Digital pheromones", "Collision avoidance"), ("Patrol",)),
    Pattern("Gossip", Purpose.DECISION, ("Gradients",), ("GossipMax",)),
    Pattern("Quorum sensing", Purpose.DECISION, ("Gradients",), ("Quorum",)),
    Pattern("Morphogenesis", Purpose.DECISION, ("Gradients", "Gossip"), ("MorphogenesisBarycenter",)),
    Pattern("Foraging", Purpose.DECISION, ("Digital pheromones",), ("ForagingDecision",)),
)
"""All patterns; one stands after those that it builds on."""
