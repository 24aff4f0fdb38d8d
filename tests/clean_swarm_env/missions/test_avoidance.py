"""The knowledge for learners: what the observation shows is enough for a rule that beats the best single option."""

import numpy as np

from benchmarks.avoidance import choices, ends_of
from tests.clean_swarm_env.courses import long_course


@long_course
def test_a_rule_on_the_situation_costs_a_crowd_less_than_the_best_single_option():
    """All six options side by side: `python -m benchmarks.avoidance`."""
    choose = choices()
    rule, single = (
        np.mean([end.result.cost_s for end in ends_of(choose[name], 20, 6)])
        for name in ("rule", "RepulsionFernandez-view0.5")
    )
    assert rule < 0.9 * single
