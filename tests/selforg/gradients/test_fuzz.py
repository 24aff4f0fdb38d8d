"""Random messages, possible and impossible: stored by the rules or refused with the field's name, never a crash."""

from hypothesis import example, given, settings

from tests.selforg.gradients.fuzz import SEQUENCES, check


@settings(max_examples=300)
@given(*SEQUENCES)
@example("max", False, False, [({}, 0.0, (0.0, 0.0)), ({}, 5e-324, (0.0, 1.0))])  # a metre in next to no time
def test_any_sequence_is_stored_or_refused_by_name(rule, torus, whole_seconds, sequence):
    check(rule, torus, whole_seconds, sequence)
