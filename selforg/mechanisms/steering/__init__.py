"""Steering mechanisms, which change what a movement commands instead of replacing it."""

from selforg.mechanisms.steering.approach import ApproachLeastBusy as ApproachLeastBusy
from selforg.mechanisms.steering.base import SteeringMechanism as SteeringMechanism
from selforg.mechanisms.steering.orca import ORCA as ORCA
from selforg.mechanisms.steering.predictive import PredictiveSteering as PredictiveSteering
