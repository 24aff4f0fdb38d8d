"""Mechanisms: one file each, with class, formula and kernel."""

from selforg.gradients.pair import Pair as Pair
from selforg.mechanisms.base import MECHANISMS as MECHANISMS
from selforg.mechanisms.base import MovementMechanism as MovementMechanism
from selforg.mechanisms.chemotaxis import ChemotaxisBalch as ChemotaxisBalch
from selforg.mechanisms.chemotaxis import ChemotaxisGe as ChemotaxisGe
from selforg.mechanisms.decisions.base import Decision as Decision
from selforg.mechanisms.decisions.base import DecisionMechanism as DecisionMechanism
from selforg.mechanisms.decisions.foraging_decision import ForagingDecision as ForagingDecision
from selforg.mechanisms.decisions.gossip_max import GossipMax as GossipMax
from selforg.mechanisms.decisions.morphogenesis_barycenter import MorphogenesisBarycenter as MorphogenesisBarycenter
from selforg.mechanisms.decisions.quorum import Quorum as Quorum
from selforg.mechanisms.depositing import DepositPheromones as DepositPheromones
from selforg.mechanisms.depositing import DepositPheromonesMin as DepositPheromonesMin
from selforg.mechanisms.depositing import DepositPheromonesRandom as DepositPheromonesRandom
from selforg.mechanisms.depositing import Patrol as Patrol
from selforg.mechanisms.depositing import Pheromone as Pheromone
from selforg.mechanisms.exploration import Exploitation as Exploitation
from selforg.mechanisms.exploration import Exploration as Exploration
from selforg.mechanisms.flocking import Flocking as Flocking
from selforg.mechanisms.flocking_reynolds import FlockingReynolds as FlockingReynolds
from selforg.mechanisms.following import AvoidAll as AvoidAll
from selforg.mechanisms.following import CollisionAvoidance as CollisionAvoidance
from selforg.mechanisms.following import FollowAll as FollowAll
from selforg.mechanisms.following import FollowMaxReach as FollowMaxReach
from selforg.mechanisms.following import FollowMin as FollowMin
from selforg.mechanisms.following import FollowMinReach as FollowMinReach
from selforg.mechanisms.following import FollowStrongest as FollowStrongest
from selforg.mechanisms.formula import FormulaMechanism as FormulaMechanism
from selforg.mechanisms.repulsion import RepulsionFernandez as RepulsionFernandez
from selforg.mechanisms.repulsion import RepulsionGradient as RepulsionGradient
from selforg.mechanisms.spreading import Carried as Carried
from selforg.mechanisms.spreading import SpreadGradient as SpreadGradient
from selforg.mechanisms.steering.approach_least_busy import ApproachLeastBusy as ApproachLeastBusy
from selforg.mechanisms.steering.base import SteeringMechanism as SteeringMechanism
from selforg.mechanisms.steering.orca import ORCA as ORCA
from selforg.mechanisms.steering.predictive_steering import PredictiveSteering as PredictiveSteering
from selforg.mechanisms.weighted_sum import WeightedSum as WeightedSum
from selforg.registry import import_modules

import_modules(__name__)
