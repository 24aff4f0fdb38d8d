"""Every mechanism has its place among the patterns of the paper's Fig. 1."""

import pytest

from docs.figures.purposes import PATTERNS, Purpose
from selforg.mechanisms import MECHANISMS, DecisionMechanism, MovementMechanism, SteeringMechanism

OF_NO_PATTERN = {"WeightedSum"}  # it adds up mechanisms of any patterns
OURS = [
    name
    for name in MECHANISMS.names()
    if MECHANISMS.find(name).__module__.startswith("selforg.") and name not in OF_NO_PATTERN
]


def test_every_registered_mechanism_has_exactly_one_place():
    assert sorted(name for pattern in PATTERNS for name in pattern.mechanisms) == OURS


@pytest.mark.parametrize("pattern", PATTERNS, ids=lambda pattern: pattern.name)
def test_mechanisms_are_of_the_kind_that_their_purpose_says(pattern):
    kinds = {Purpose.MOVEMENT: (MovementMechanism, SteeringMechanism), Purpose.DECISION: DecisionMechanism}
    for name in pattern.mechanisms:
        assert issubclass(MECHANISMS.find(name), kinds.get(pattern.purpose, object))


def test_patterns_build_on_earlier_ones_and_all_advanced_ones_on_gradients():
    built_on: dict[str, set[str]] = {}
    for pattern in PATTERNS:
        built_on[pattern.name] = set(pattern.builds_on).union(*(built_on[name] for name in pattern.builds_on))
    assert all("Gradients" in built_on[p.name] for p in PATTERNS if p.purpose is not Purpose.BASIC)
