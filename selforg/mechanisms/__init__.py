"""Mechanisms: one short formula and one registered class each."""

from selforg.mechanisms.base import MovementMechanism as MovementMechanism
from selforg.mechanisms.chemotaxis import ChemotaxisBalch as ChemotaxisBalch
from selforg.mechanisms.chemotaxis import ChemotaxisGe as ChemotaxisGe
from selforg.mechanisms.depositing import DepositPheromones as DepositPheromones
from selforg.mechanisms.depositing import DepositPheromonesMin as DepositPheromonesMin
from selforg.mechanisms.depositing import DepositPheromonesRandom as DepositPheromonesRandom
from selforg.mechanisms.depositing import Patrol as Patrol
from selforg.mechanisms.depositing import Pheromone as Pheromone
from selforg.mechanisms.flocking import Flocking as Flocking
from selforg.mechanisms.flocking import FlockingReynolds as FlockingReynolds
from selforg.mechanisms.following import AvoidAll as AvoidAll
from selforg.mechanisms.following import CollisionAvoidance as CollisionAvoidance
from selforg.mechanisms.following import FollowAll as FollowAll
from selforg.mechanisms.following import FollowMaxReach as FollowMaxReach
from selforg.mechanisms.following import FollowMin as FollowMin
from selforg.mechanisms.following import FollowMinReach as FollowMinReach
from selforg.mechanisms.following import FollowStrongest as FollowStrongest
from selforg.mechanisms.registry import create as create
from selforg.mechanisms.registry import find as find
from selforg.mechanisms.registry import names as names
from selforg.mechanisms.registry import register as register
from selforg.mechanisms.repulsion import RepulsionFernandez as RepulsionFernandez
from selforg.mechanisms.repulsion import RepulsionGradient as RepulsionGradient
from selforg.mechanisms.wandering import Exploitation as Exploitation
from selforg.mechanisms.wandering import Exploration as Exploration
