import numpy as np
import pytest

from selforg.gradients import pair
from selforg.gradients.pair import Own, choose
from selforg.gradients.store import columns as c

OWN = Own(0.5, 1.5, 2.0)
RULES = [name for name in dir(pair) if name.startswith("CHOOSE_")]


@pytest.mark.parametrize("rule", RULES)
def test_nothing_is_chosen_where_there_is_nothing(rule):
    assert choose(getattr(pair, rule), np.zeros((3, c.PAIR_COLUMNS)), 0, OWN) == -1


@pytest.mark.parametrize(("rule", "chosen"), [("CHOOSE_NEAREST", 0), ("CHOOSE_FARTHEST", 2)])
def test_the_nearest_and_the_farthest_are_chosen(rule, chosen):
    pairs = np.zeros((3, c.PAIR_COLUMNS))
    pairs[:, c.PAIR_DISTANCE], pairs[:, c.PAIR_SIGN], pairs[:, c.PAIR_DIFFUSION] = (2.0, 4.0, 6.0), 1.0, 9.0
    assert choose(getattr(pair, rule), pairs, 3, OWN) == chosen
