"""The knowledge for learners: what the observation shows is enough for a rule that no single option reaches."""

import numpy as np
import pytest

from clean_swarm_env.batch import Batch
from clean_swarm_env.observation_terms import TERMS
from tests.env.courses import long_course, mission

FREE, CARRYING_FAR, CARRYING_NEAR = (
    "RepulsionFernandez-view1.5",
    "RepulsionGradient-from0.25",
    "RepulsionFernandez-view0.5",
)
WORLDS, PRICE = 6, 5.0  # [s] for a collision event


def cost_of(choose, robots: int, limit: float) -> float:
    """Return the mean cost [s] of missions in which options are chosen by the situation (R, 4) that robots see."""
    config = mission(robots={"count": robots}, knowledge="avoidance", time_limit=limit)
    batch = Batch(config, WORLDS, begin_anew=False)
    batch.reset(list(range(900, 900 + WORLDS)))
    columns = [batch.observer.names.index(name) for name in TERMS["situation"][1]]
    ends = []
    while len(ends) < WORLDS:
        batch.step(choose(batch.observations[:, columns], batch.options["AvoidCollision"]))
        ends += batch.finished
    return float(np.mean([end.result.duration_s + PRICE * end.collision_events for end in ends]))


def by_rule(situation, options):
    rule = np.array([options.index(name) for name in (FREE, FREE, CARRYING_FAR, CARRYING_NEAR)])
    return rule[situation.argmax(axis=1)]


@long_course
@pytest.mark.parametrize("robots", [20])
def test_a_rule_on_what_is_observed_costs_less_than_any_single_option(robots):
    cost = cost_of(by_rule, robots, 200.0)
    singles = {}
    for option in Batch(mission(knowledge="avoidance")).options["AvoidCollision"]:
        singles[option] = cost_of(lambda seen, names, o=option: np.full(len(seen), names.index(o)), robots, 200.0)
    assert cost < 0.85 * min(singles.values()), (cost, singles)
